# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the table of scripts/bench-ompl --se3 from the RUN lines of both programs (tests/bench/rrt_bench.hpp says what is
# in them).

BEGIN { FS = "\t" }

$1 == "RUN" {
  side = $2 " " $3
  run = side SUBSEP $4 SUBSEP $5
  if (!($4 in known_scene)) { known_scene[$4] = 1; scenes[++scene_count] = $4 }
  if (!(side in known_side)) { known_side[side] = 1; sides[++side_count] = side }
  found = $6 " " $9 " " $10 " " $11
  if (!(run in what)) {
    what[run] = found
    cpu[run] = $7
    seed[side, $4, ++count[side, $4]] = $5
  }
  # Times of different searches must not be compared.
  if (what[run] != found) {
    print "bench-ompl: " side ", " $4 ", seed " $5 ": two runs differ" > "/dev/stderr"
    failed = 1
    exit 1
  }
  if ($7 < cpu[run]) cpu[run] = $7
}

# The median of values[1..n], which it sorts.
function median(values, n,    i, j, v) {
  for (i = 2; i <= n; ++i) {
    v = values[i]
    for (j = i - 1; j >= 1 && values[j] > v; --j) values[j + 1] = values[j]
    values[j + 1] = v
  }
  return n % 2 ? values[(n + 1) / 2] : 0.5 * (values[n / 2] + values[n / 2 + 1])
}

function ratio(a, b) { return b > 0 ? sprintf("%.2f", a / b) : "-" }

END {
  if (failed) exit 1
  printf "%-6s %-18s %7s %9s %9s %10s %8s %11s %9s %9s\n", "scene", "side", "solved", "CPU ms", "total s", "checks", \
    "nodes", "iterations", "us/iter", "us/check"
  for (i = 1; i <= scene_count; ++i) {
    scene = scenes[i]
    for (j = 1; j <= side_count; ++j) {
      side = sides[j]
      n = count[side, scene]
      if (!n) continue
      solved = all = all_iterations = all_checks = 0
      for (k = 1; k <= n; ++k) {
        run = side SUBSEP scene SUBSEP seed[side, scene, k]
        split(what[run], field, " ")
        solved += field[1]
        times[k] = cpu[run]
        iterations[k] = field[2]
        checks[k] = field[3]
        nodes[k] = field[4]
        all += cpu[run]
        all_iterations += field[2]
        all_checks += field[3]
      }
      middle[side, scene] = median(times, n)
      total[side, scene] = all
      per_iteration[side, scene] = all / all_iterations
      printf "%-6s %-18s %7s %9.0f %9.2f %10d %8d %11d %9.2f %9.2f\n", scene, side, solved "/" n, \
        1e3 * middle[side, scene], all, median(checks, n), median(nodes, n), median(iterations, n), \
        1e6 * per_iteration[side, scene], 1e6 * all / all_checks
    }
  }
  print "CPU ms, checks, nodes, iterations: medians; us/iter: all CPU time by all iterations."
  printf "\n%-40s %12s %12s %12s\n", "OMPL's CPU time by ours", "median", "total", "iteration"
  for (i = 1; i <= scene_count; ++i) {
    scene = scenes[i]
    for (j = 1; j <= side_count; ++j) {
      side = sides[j]
      if (side ~ /^ompl/) continue
      printf "%-40s %12s %12s %12s\n", "  " scene ", " side, ratio(middle["ompl fcl", scene], middle[side, scene]), \
        ratio(total["ompl fcl", scene], total[side, scene]), \
        ratio(per_iteration["ompl fcl", scene], per_iteration[side, scene])
    }
  }
}
