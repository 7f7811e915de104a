// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/instance/instance.hpp>

namespace trellis {

/// Returns a path with the midpoint of each motion that turns a circle or a rotation by half a period, to within
/// rounding. The ends of such a motion do not say in which direction it turns, and a planner may have validated it from
/// either end; with its midpoint, all motions of the path turn by clearly less. The midpoint is that of the motion from
/// the earlier point to the later one if that is certified; else, if the motion back is, of that one. Other points
/// stay. \param validity  certifies such motions \param path  straight motions in the space \param tolerance  metres,
/// see Certificate::tolerance
Configurations with_half_turns_divided(const Space& space, Validity& validity, const Configurations& path,
                                       double tolerance);

}  // namespace trellis
