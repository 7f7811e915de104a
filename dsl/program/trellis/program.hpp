// SPDX-License-Identifier: GPL-3.0-or-later
// The command `trellis` for a program of one's own, which registers planners first. See docs/planner.md.
#pragma once

namespace trellis {

/// Does what the command `trellis` does with these arguments, and returns its exit status. Call it once.
int run_program(int argc, char** argv);

}  // namespace trellis
