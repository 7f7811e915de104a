// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/report.hpp>

namespace trellis {

std::string version() { return TRELLIS_VERSION; }

}  // namespace trellis
