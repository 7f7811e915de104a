# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the table of scripts/bench-ompl --star from lines "SIDE STAR PLANNER SCENE SEED SECONDS LENGTH", those of a run in
# the order of time: the median length over the seeds (a run without a path is infinitely long), and the seeds that have
# one.

BEGIN {
  FS = "\t"
  columns = split("0.002 0.005 0.01 0.02 0.05 0.1 0.2", at, " ")
}

{
  key = $4 SUBSEP $3 SUBSEP $1
  if (!(key in known)) { known[key] = 1; keys[++count] = key }
  for (i = 1; i <= columns; ++i) {
    if ($6 <= at[i]) best[key, $5, i] = $7
  }
}

function median(key, column,    n, i, j, v, values) {
  n = 0
  for (i = 1; i <= seeds; ++i) if ((key, i, column) in best) values[++n] = best[key, i, column]
  solved = n
  if (2 * n <= seeds) return "-"
  for (i = 2; i <= n; ++i) {
    v = values[i]
    for (j = i - 1; j >= 1 && values[j] > v; --j) values[j + 1] = values[j]
    values[j + 1] = v
  }
  if (seeds % 2 == 1) return sprintf("%.2f", values[(seeds + 1) / 2])
  return sprintf("%.2f", (values[seeds / 2] + values[seeds / 2 + 1]) / 2)
}

END {
  printf "%-16s %-18s %-8s", "length (seeds)", "", ""
  for (i = 1; i <= columns; ++i) printf " %11s", 1e3 * at[i] " ms"
  print ""
  for (k = 1; k <= count; ++k) {
    split(keys[k], part, SUBSEP)
    printf "%-16s %-18s %-8s", part[1], part[2], part[3]
    for (i = 1; i <= columns; ++i) {
      length_of = median(keys[k], i)
      printf " %11s", length_of " (" solved ")"
    }
    print ""
  }
}
