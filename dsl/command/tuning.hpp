// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include <trellis/experiment/tuning.hpp>

namespace trellis {

/// Returns the result of a tuning for a terminal: a table of the strategies, the winner on held-out seeds, and the
/// winner in the syntax of a script.
std::string tuning_text(const Experiment& experiment, const TuneSettings& settings, const TuneResult& result,
                        std::size_t width);

}  // namespace trellis
