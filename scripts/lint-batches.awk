# SPDX-License-Identifier: GPL-3.0-or-later
# Puts together what scripts/lint gives to clang-tidy in one run. Reads "SOURCE<tab>COMPILE COMMAND" of all sources,
# "SOURCE<tab>FILE" of all of ours that they include, and "SOURCE<tab>KEY" of the sources to check. Prints one batch a
# line: "SOURCE<tab>KEY<tab>SOURCE<tab>KEY...".
#
# The sources of a batch are compiled alike, have `most` lines in all, and what is in the unnamed namespaces of one has
# no name that another has there, nor that of a type in a header of another. Names are guessed from the lines that are
# not indented; where the guess is wrong, the batch does not compile.
BEGIN { FS = "\t" }

FNR == 1 { input++ }

input == 1 {
  sub(/ -o .*/, "", $2)
  alike[$1] = $2
  next
}

input == 2 {
  if ($1 != $2) includes[$1] = includes[$1] FS $2
  next
}

# The name that a line declares, or nothing.
function declared(line) {
  while (gsub(/<[^<>]*>/, "", line)) continue
  if (sub(/^(struct|class|enum class|enum|union|using) /, "", line)) {
    match(line, /^[A-Za-z_0-9]+/)
    return RSTART == 0 || line ~ /^[A-Za-z_0-9]+::/ ? "" : substr(line, 1, RLENGTH)
  }
  if (!match(line, /[A-Za-z_][A-Za-z_0-9]*(\(|\{|\[|;| =)/) || substr(line, RSTART - 1, 1) == ":") return ""
  line = substr(line, RSTART)
  match(line, /^[A-Za-z_0-9]+/)
  return substr(line, 1, RLENGTH)
}

# The types of a header, each after a tab.
function types(header,    line, name) {
  if (header in types_of) return types_of[header]
  types_of[header] = ""
  while ((getline line < header) > 0)
    if (line ~ /^(struct|class|enum|using) / && (name = declared(line)) != "")
      types_of[header] = types_of[header] FS name
  close(header)
  return types_of[header]
}

function clashes(at,    name) {
  for (name in names) if ((at, name) in unnamed_in || !(name in known) && (at, name) in known_in) return 1
  for (name in known) if ((at, name) in alone_in) return 1
  return 0
}

{
  split("", names)
  split("", known)
  count = split(substr(includes[$1], 2), headers)
  for (i = 1; i <= count; i++) {
    several = split(substr(types(headers[i]), 2), part)
    for (j = 1; j <= several; j++) known[part[j]] = 1
  }
  lines = unnamed = 0
  while ((getline line < $1) > 0) {
    lines++
    if (line ~ /^namespace \{/) unnamed = 1
    else if (line ~ /^\}  \/\/ namespace$/) unnamed = 0
    else if (unnamed && line ~ /^[a-zA-Z]/ && line !~ /^(namespace |static_assert)/) names[declared(line)] = 1
  }
  delete names[""]
  close($1)
  for (at = 1; at <= batches; at++)
    if (of[at] == alike[$1] && size[at] + lines <= most && !clashes(at)) break
  if (at > batches) {
    batches = at
    of[at] = alike[$1]
  }
  size[at] += lines
  for (name in known) known_in[at, name] = 1
  for (name in names) {
    unnamed_in[at, name] = 1
    # Next to a type of the same name in its own headers it does well.
    if (!(name in known)) alone_in[at, name] = 1
  }
  batch[at] = batch[at] (batch[at] == "" ? "" : FS) $1 FS $2
}

END { for (at = 1; at <= batches; at++) print batch[at] }
