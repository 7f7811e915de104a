# SPDX-License-Identifier: GPL-3.0-or-later
# Puts sources into groups that compile as one source: for unity builds (cmake/unity.cmake) and for scripts/lint. Reads
# lines "KIND<tab>SOURCE" and prints "SOURCE<tab>GROUP"; the sources of a group are of one kind, and no other group has
# its name. Variables: `folders`, where headers are searched, separated by colons; `most`, the lines of a group; `alone`,
# a pattern of includes whose sources are in no group; `loose`, where a group that does not compile does no harm. With
# `show` set to "includes" it prints "SOURCE<tab>FILE" instead, for the source itself and for every file of ours that
# it includes.
#
# A name of a source's unnamed namespace is visible in the rest of its group. So no other source of the group has that
# word (of a function: calls or declares it; `loose`: declares that name), unless it declares the same alias, and no
# header declares that name which only others include. Names are those that lines without indentation declare.
BEGIN { FS = "\t" }

# The name that a line declares, or nothing.
function declared(line) {
  while (gsub(/<[^<>]*>/, "", line)) continue
  if (sub(/^(struct|class|enum class|enum|union|using|namespace) /, "", line)) {
    match(line, /^[A-Za-z_0-9]+/)
    return RSTART == 0 || line ~ /^[A-Za-z_0-9]+::/ ? "" : substr(line, 1, RLENGTH)
  }
  if (!match(line, /[A-Za-z_][A-Za-z_0-9]*(\(|\{|\[|;| =)/) || substr(line, RSTART - 1, 1) == ":") return ""
  line = substr(line, RSTART)
  match(line, /^[A-Za-z_0-9]+/)
  return substr(line, 1, RLENGTH)
}

function exists(file,    line, found) {
  if (file in found_) return found_[file]
  found = (getline line < file) >= 0
  close(file)
  return found_[file] = found
}

# The file that an include of another file names, or nothing: a header of a library.
function resolved(name, from,    file, i) {
  file = from
  sub(/[^\/]*$/, name, file)
  if (exists(file)) return file
  for (i = 1; i <= folder_count; i++) if (exists(folder[i] "/" name)) return folder[i] "/" name
  return ""
}

# Reads a file once: the files that it includes, its lines, the names in its unnamed namespaces (of functions with a
# parenthesis), and the words that those of other sources must not be: of a source all, of a header the names that it
# declares.
function scan(file,    line, source, unnamed, name, header, rest, part, parts, i) {
  if (file in lines_of) return
  lines_of[file] = 0
  source = file ~ /\.cpp$/
  while ((getline line < file) > 0) {
    lines_of[file]++
    if (line ~ /^#include /) {
      name = line
      sub(/^#include [<"]/, "", name)
      sub(/[>"].*/, "", name)
      if (alone != "" && name ~ alone) lone[file] = 1
      else if ((header = resolved(name, file)) != "") direct[file] = direct[file] FS header
      continue
    }
    if (line ~ /^}  \/\/ namespace$/) unnamed = 0
    gsub(/\\./, "", line)
    gsub(/"[^"]*"/, "", line)
    sub(/\/\/.*/, "", line)
    if (line ~ /^namespace \{/) {
      unnamed = 1
      continue
    }
    name = line ~ /^[a-zA-Z]/ && line !~ /^(static_assert|template <|namespace [a-z:]* *\{)/ ? declared(line) : ""
    if (name != "") note_declared(file, name)
    if (name != "" && source && (unnamed || line ~ /^(using [A-Za-z_]+ =|namespace )/)) {
      names_of[file] = names_of[file] FS (line !~ /^(struct|class|enum|union|using|namespace|constexpr|const) / && index(line, name "(") ? name "(" : name)
      if (line ~ /^(using|namespace) /) alias[file, name] = line
      rest = line ~ /^constexpr [^(]*$/ ? line : ""
      while (match(rest, /, [A-Za-z_]+ =/)) {
        names_of[file] = names_of[file] FS substr(rest, RSTART + 2, RLENGTH - 4)
        rest = substr(rest, RSTART + RLENGTH)
      }
    }
    if (!source || loose) continue
    gsub(/(\.|->)[A-Za-z0-9_]+/, "", line)
    parts = split(line, part, /[^A-Za-z0-9_]+/)
    for (i = 1; i <= parts; i++) note(file, part[i])
    while (match(line, /[A-Za-z_][A-Za-z_0-9]*\(/)) {
      note(file, substr(line, RSTART, RLENGTH))
      line = substr(line, RSTART + RLENGTH)
    }
  }
  close(file)
}

function note_declared(file, name) {
  note(file, name)
  note(file, name "(")
}

function note(file, name) {
  if ((file, name) in word) return
  word[file, name] = 1
  having[name] = having[name] FS file
}

# All files that a file includes, itself too, each after a tab.
function closure(file,    pending, count, at, seen, part, parts, i, all) {
  pending[count = 1] = file
  seen[file] = 1
  for (at = 1; at <= count; at++) {
    scan(pending[at])
    all = all FS pending[at]
    parts = split(substr(direct[pending[at]], 2), part)
    for (i = 1; i <= parts; i++) if (!(part[i] in seen)) {
      seen[part[i]] = 1
      pending[++count] = part[i]
    }
  }
  return all
}

function same_alias(a, b, name) { return (a, name) in alias && alias[a, name] == alias[b, name] }

# Whether a name of source a is in source b, or in a header that b includes and a does not.
function shadows(a, b,    name, names, part, parts, i, k) {
  names = split(substr(names_of[a], 2), name)
  for (i = 1; i <= names; i++) {
    parts = split(substr(having[name[i]], 2), part)
    for (k = 1; k <= parts; k++)
      if (part[k] == b ? !same_alias(a, b, name[i]) : (b, part[k]) in includes && !((a, part[k]) in includes)) return 1
  }
  return 0
}

# A name for a group by its first source, so that new sources elsewhere do not change what ccache compares.
function group_name(file,    part, parts, name) {
  parts = split(substr(file, 1, length(file) - 4), part, "/")
  name = part[parts - 1] "_" part[parts]
  while (name in taken) name = name "_"
  taken[name] = 1
  return name
}

NR == 1 { folder_count = split(folders, folder, ":") }
{
  parts = split(substr(closure($2), 2), part)
  if (show == "includes") {
    for (i = 1; i <= parts; i++) print $2 "\t" part[i]
    next
  }
  if ($2 in lone) next
  kind[++count] = $1
  source[count] = $2
  for (i = 1; i <= parts; i++) includes[$2, part[i]] = 1
}

# Sources that clash with many others choose their groups first, which makes fewer groups.
END {
  for (a = 1; a <= count; a++) {
    for (b = 1; b < a; b++) {
      if (kind[a] != kind[b] || !(shadows(source[a], source[b]) || shadows(source[b], source[a]))) continue
      clash[a, b] = clash[b, a] = 1
      clashes[a]++
      clashes[b]++
      if (clashes[a] > most_clashes) most_clashes = clashes[a]
      if (clashes[b] > most_clashes) most_clashes = clashes[b]
    }
  }
  for (number = most_clashes + 0; number >= 0; number--) for (at = 1; at <= count; at++) if (clashes[at] + 0 == number) {
    for (group = 1; group <= groups; group++) {
      if (of[group] != kind[at] || size[group] + lines_of[source[at]] > most) continue
      members = split(substr(members_of[group], 2), member)
      for (i = 1; i <= members; i++) if ((at, member[i]) in clash) break
      if (i > members) break
    }
    if (group > groups) {
      of[groups = group] = kind[at]
      name_of[group] = group_name(source[at])
    }
    size[group] += lines_of[source[at]]
    members_of[group] = members_of[group] FS at
    print source[at] "\t" name_of[group]
  }
}
