# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What the scripts of this folder share. Sourced, never run.

# The caller's folder is left alone: paths on a command line mean what they say.
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)

die() {
  printf '%s: %s\n' "${0##*/}" "$1" >&2
  exit "${2:-1}"
}

# The comment at the head of the calling script is its help text.
usage() {
  awk 'NR > 2 && !/^#/ { exit } NR > 2 { sub(/^# ?/, ""); print }' "$0"
}

# The folder of scene files made by others, for the program and its tests: TRELLIS_SCENES, else ../shared/scenes where
# that exists.
find_scenes() {
  if [[ -z ${TRELLIS_SCENES:-} && -d $root/../shared/scenes ]]; then
    TRELLIS_SCENES=$(cd -- "$root/../shared/scenes" && pwd -P)
    export TRELLIS_SCENES
  fi
}

# The Python that has pandas and matplotlib, as the program finds it: TRELLIS_PYTHON, else the first python3.
find_python() {
  local one
  for one in ${TRELLIS_PYTHON:-python3 /usr/bin/python3}; do
    if "$one" -c 'import matplotlib, pandas' 2>/dev/null; then
      printf '%s\n' "$one"
      return
    fi
  done
  die 'tables need Python 3 with matplotlib and pandas (Debian: python3-matplotlib, python3-pandas)'
}

# One CGAL source takes up to 2.4 GB to compile, so memory limits the jobs as the cores do.
build_jobs() {
  if [[ -n ${TRELLIS_JOBS:-} ]]; then
    printf '%s\n' "$TRELLIS_JOBS"
    return
  fi
  local cores fit
  cores=$(nproc)
  fit=$(awk '/^MemAvailable:/ { print int($2 / 2500000) }' /proc/meminfo)
  ((fit >= 1)) || fit=1
  printf '%s\n' "$((cores < fit ? cores : fit))"
}

# Follows a command's output: keeps it in a log, and after three seconds shows on stderr how far it is, on one line of a
# terminal, or elsewhere as a line each half minute. The time left assumes that the other steps take as long as those done.
follow() {
  local what=$1 log=$2 started=$EPOCHSECONDS shown=0 partial='' line step='' finished=0 steps=0 left status text
  exec 8>"$log"
  while true; do
    status=0
    IFS= read -r -t 1 line || status=$?
    partial+=$line
    if ((status == 0)); then
      printf '%s\n' "$partial" >&8
      if [[ $partial =~ ^\[([0-9]+)/([0-9]+)\]\  ]]; then
        finished=${BASH_REMATCH[1]} steps=${BASH_REMATCH[2]} step=" $finished/$steps"
      fi
      partial=''
    elif ((status <= 128)); then
      break
    fi
    local elapsed=$((EPOCHSECONDS - started))
    ((elapsed >= 3)) || continue
    # The first steps are too few to tell.
    left=''
    if ((10 * finished >= steps && finished > 0)); then
      left=$((elapsed * (steps - finished) / finished))
      printf -v left ', about %d:%02d left' "$((left / 60))" "$((left % 60))"
    fi
    printf -v text '%s%s (%d:%02d%s)' "$what" "$step" "$((elapsed / 60))" "$((elapsed % 60))" "$left"
    if [[ -t 2 ]]; then
      printf '\r\033[K%s' "$text" >&2
      shown=1
    elif ((shown == 0 || EPOCHSECONDS - shown >= 30)); then
      printf '%s\n' "$text" >&2
      shown=$EPOCHSECONDS
    fi
  done
  [[ -z $partial ]] || printf '%s\n' "$partial" >&8
  if [[ -t 2 ]] && ((shown)); then printf '\r\033[K' >&2; fi
}

# quietly WHAT LOG COMMAND...: says nothing unless the command is slow or fails; then what it said, less the progress.
quietly() {
  local what=$1 log=$2
  shift 2
  mkdir -p -- "$(dirname -- "$log")"
  if "$@" </dev/null 2>&1 | follow "$what" "$log"; then return 0; fi
  grep -Ev '^\[[0-9]+/[0-9]+\] ' -- "$log" >&2 || true
  printf '%s failed; all it said is in %s\n' "$what" "$log" >&2
  return 1
}

# locked PRESET: waits for another script that configures or builds this preset, and keeps others waiting. Held until
# `unlocked`, so that what is built does not hold it while it runs.
locked() {
  mkdir -p -- "$root/build"
  exec 9>"$root/build/$1.lock"
  flock 9
}
unlocked() { exec 9>&-; }

# configure PRESET: ninja configures again by itself after a change, except where the presets themselves changed.
configure() {
  local preset=$1 made
  made=$root/build/$preset/build.ninja
  if [[ -f $made && ! $root/CMakePresets.json -nt $made ]]; then return 0; fi
  quietly "configuring $preset" "$root/build/$preset.configure.log" cmake -S "$root" --preset "$preset" || return 1
  # A preset file that changes nothing leaves the build files alone: note that it was seen.
  touch -- "$made"
}

# build PRESET [TARGET...]: its own status says whether it did, so that it may be called where errexit is off.
build() {
  local preset=$1 status=0
  shift
  locked "$preset"
  if configure "$preset"; then
    quietly "building $preset" "$root/build/$preset.build.log" \
      ninja -C "$root/build/$preset" -j "$(build_jobs)" "$@" || status=1
  else
    status=1
  fi
  unlocked
  return "$status"
}
