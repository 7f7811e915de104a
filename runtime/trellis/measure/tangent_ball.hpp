// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/space/space.hpp>

namespace trellis::measure {

/// Maps the unit cube to the unit ball with uniform density: normal deviates give the direction.
/// \param unit   as many numbers as `out`
/// \param level  one more, for the radius
void in_unit_ball(View unit, double level, MutableView out);

/// Whether a tangent vector is the shortest one to its end: no circle turns by more than half a period, no rotation by
/// more than a half turn. Longer tangent vectors reach points a second time.
bool before_cut(const Space& space, View tangent);

}  // namespace trellis::measure
