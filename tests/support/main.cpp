// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>

// What tests read of robots is not stored in the user's cache folder.
[[maybe_unused]] static const int no_cache = ::setenv("TRELLIS_NO_CACHE", "1", 1);

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_session.hpp>
int main(int argc, char** argv) { return Catch::Session().run(argc, argv); }
#else
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
#endif
