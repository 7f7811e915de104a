#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# complete.bash COMPLETION WORD...: what bash offers for the last WORD of a command line, by the file COMPLETION, a line
# each.
# No errexit: an interactive shell has none.
set -uo pipefail
# Outside of a completion that readline asked for it can only fail.
compopt() { :; }
# shellcheck source=/dev/null
source "$1"
shift
# shellcheck disable=SC2034  # the completion reads them
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
_trellis
printf '%s\n' "${COMPREPLY[@]}"
