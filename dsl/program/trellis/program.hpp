// SPDX-License-Identifier: GPL-3.0-or-later
// The command `trellis` for a program of one's own, which registers planners first. See docs/planner.md.
#pragma once

namespace trellis {

/// Does what the command `trellis` does with these arguments. Call it once, from the thread of `main`, after the last
/// register_planner().
/// \param argv  `argc` texts, the first of which is the name of the program
/// \return the exit status: 0 for success; the manual page lists the others
int run_program(int argc, char** argv);

}  // namespace trellis
