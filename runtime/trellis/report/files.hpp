// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace trellis {

/// Writes all bytes to an open file, also where a signal interrupts.
/// \param file  a file descriptor
/// \return 0, or the system's error number; then a part of the bytes may have been written
int write_all(int file, std::string_view content);

}  // namespace trellis
