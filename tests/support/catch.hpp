// SPDX-License-Identifier: GPL-3.0-or-later
// The only header that includes Catch2: Debian 12 has version 2, later releases version 3.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;  // NOLINT(misc-unused-using-decls)
#else
#include <catch2/catch.hpp>
#endif
