// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/base/configurations.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/input_file.hpp>
#include <trellis/base/lua_time.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/base/printable.hpp>
#include <trellis/base/random.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"

using namespace trellis;

TEST_CASE("streams depend on seed, level and purpose, and on nothing else", "[random]") {
  Stream a(1, "0", "proposals");
  Stream b(1, "0", "proposals");
  Stream seed(2, "0", "proposals");
  Stream level(1, "0/0", "proposals");
  Stream purpose(1, "0", "lift");
  for (int i = 0; i < 100; ++i) {
    const auto bits = a.bits();
    CHECK(bits == b.bits());
    CHECK(bits != seed.bits());
    CHECK(bits != level.bits());
    CHECK(bits != purpose.bits());
  }
  // The boundary between level and purpose counts.
  CHECK(Stream(1, "ab", "c").bits() != Stream(1, "a", "bc").bits());
}

TEST_CASE("the stream is the same on every machine", "[random][determinism]") {
  Stream stream(42, "0", "golden");
  const std::vector<std::uint64_t> drawn = {stream.bits(), stream.bits(), stream.bits()};
  Stream again(42, "0", "golden");
  CHECK(again.uniform() == static_cast<double>(drawn[0] >> 11) * 0x1.0p-53);
  CHECK(stable_hash("") == 0xcbf29ce484222325ULL);
  CHECK(stable_hash("a") == 0xaf63dc4c8601ec8cULL);
}

TEST_CASE("uniform, below and normal have the moments they should", "[random]") {
  Stream stream(3, "0", "moments");
  constexpr int n = 200000;
  double mean = 0.0;
  double square = 0.0;
  double normal_mean = 0.0;
  double normal_square = 0.0;
  std::vector<int> counts(7, 0);
  for (int i = 0; i < n; ++i) {
    const double u = stream.uniform();
    REQUIRE((u >= 0.0 && u < 1.0));
    mean += u / n;
    square += u * u / n;
    const double z = stream.normal();
    normal_mean += z / n;
    normal_square += z * z / n;
    ++counts[stream.below(7)];
  }
  CHECK(mean == Approx(0.5).margin(0.003));
  CHECK(square == Approx(1.0 / 3.0).margin(0.003));
  CHECK(normal_mean == Approx(0.0).margin(0.01));
  CHECK(normal_square == Approx(1.0).margin(0.02));
  for (const int c : counts) CHECK(c == Approx(n / 7.0).epsilon(0.03));
}

TEST_CASE("the nearest name is offered only when it is near", "[error]") {
  const std::vector<std::string> known = {"step", "goal_bias", "uniform"};
  CHECK(nearest_name("stepp", known) == "step");
  CHECK(nearest_name("goalbias", known) == "goal_bias");
  CHECK(nearest_name("colour", known).empty());
  // The time would grow with the square of the length.
  const std::vector<std::string> long_names = {std::string(400'000, 'a')};
  CHECK(nearest_name(std::string(399'999, 'a'), long_names).empty());
  CHECK(did_you_mean("unifrom", known) == " (did you mean 'uniform'?)");
}

TEST_CASE("an arena keeps rows, even when one of its own is pushed", "[configurations]") {
  Configurations rows(3);
  rows.push(Configuration{1, 2, 3});
  for (int i = 0; i < 100; ++i) rows.push(std::as_const(rows)[0]);
  REQUIRE(rows.size() == 101);
  for (std::size_t i = 0; i < rows.size(); ++i) CHECK(std::as_const(rows)[i][2] == 3.0);
}

TEST_CASE("copies and moves of rows: a copy is its own, what was moved from is empty", "[configurations]") {
  Configurations rows(2);
  for (int i = 0; i < 1000; ++i) rows.push(Configuration{double(i), -double(i)});
  Configurations copy(rows);
  rows[7][0] = 100.0;
  CHECK(std::as_const(copy)[7][0] == 7.0);
  copy = rows;
  CHECK(std::as_const(copy)[7][0] == 100.0);
  const Configurations& same = copy;
  copy = same;
  CHECK(copy.size() == 1000);
  Configurations moved(std::move(copy));
  CHECK(moved.size() == 1000);
  CHECK(copy.empty());  // NOLINT(bugprone-use-after-move): the test asks for it
  copy = Configurations(3);
  CHECK(copy.push(Configuration{1, 2, 3}) == 0);
  CHECK(copy.dimension() == 3);
  copy = std::move(moved);
  CHECK(copy.dimension() == 2);
  CHECK(copy.back()[1] == -999.0);
  moved.clear();  // NOLINT(bugprone-use-after-move): the test asks for it
  CHECK(moved.push(Configuration{4, 5}) == 0);
  Configurations none;
  none = Configurations(none);
  CHECK(none.values().empty());
  none.reserve(10);
  CHECK(none.size() == 0);
}

TEST_CASE("an option's number is printed so that it reads back, at the ends of doubles too", "[component]") {
  for (const double x : {0.1, 1.0 / 3.0, 1e-310, 5e-324, 1e308, -1e-300, 9007199254740993.0, 0.0}) {
    const std::string text = to_string(OptionValue(x));
    CAPTURE(x, text);
    CHECK(parse_number(text) == x);
  }
  CHECK(to_string(OptionValue(0.25)) == "0.25");
  CHECK(std::isnan(parse_number("none")));
}

TEST_CASE("a printable text has nothing that a terminal obeys", "[printable]") {
  CHECK(printable("plain text,\n\tin two lines") == "plain text,\n\tin two lines");
  CHECK(printable("käse → 日本 🙂") == "käse → 日本 🙂");
  CHECK(printable("\x1b]0;title\x07") == "\\x1b]0;title\\x07");
  CHECK(printable(std::string_view("a\0b", 3)) == "a\\x00b");
  CHECK(printable("over\rwritten\x7f") == "over\\x0dwritten\\x7f");
  CHECK(printable("\xc2\x9b"
                  "2J") == "\\u{009b}2J");
  CHECK(printable("\xe2\x80\xae"
                  "abc") == "\\u{202e}abc");
  // Bytes that are not UTF-8: alone, cut short, too long, a surrogate, beyond the last character.
  CHECK(printable("\x9b") == "\\x9b");
  CHECK(printable("\xe2\x80") == "\\xe2\\x80");
  CHECK(printable("\xc0\xaf") == "\\xc0\\xaf");
  CHECK(printable("\xed\xa0\x80") == "\\xed\\xa0\\x80");
  CHECK(printable("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
}

TEST_CASE("input files are regular files within a limit", "[input]") {
  const test::Folder folder;
  const std::string file = folder.write("a.txt", "0123456789");
  CHECK(InputFile(file, 10).rest() == "0123456789");
  CHECK(input_fault(file, 10).empty());
  CHECK(input_fault(file, 9) == "it has 10 bytes, at most 9 are read");
  std::filesystem::create_symlink("a.txt", folder.file("link"));
  CHECK(InputFile(folder.file("link"), 10).rest() == "0123456789");
  CHECK(input_fault(folder.file("none"), 10) == "No such file or directory");
  CHECK(input_fault(folder.path().string(), 10) == "it is a folder");
  CHECK(input_fault("/dev/zero", 10) == "it is a device; expected a regular file");
  REQUIRE(::mkfifo(folder.file("pipe").c_str(), 0600) == 0);
  CHECK(input_fault(folder.file("pipe"), 10) == "it is a pipe; expected a regular file");
  // The size of some files is known only when they have been read.
  InputFile grown("/proc/self/maps", 3);
  CHECK(grown.rest().empty());
  CHECK(grown.fault().find("at most 3 are read") != std::string::npos);
}

TEST_CASE("long work polls the function of the innermost scope of its thread", "[polling]") {
  poll();  // without a scope it does nothing
  int outer = 0;
  int inner = 0;
  const std::function<void()> count_outer = [&] { ++outer; };
  const std::function<void()> count_inner = [&] { ++inner; };
  const PollScope scope(count_outer);
  poll();
  {
    const PollScope within(count_inner);
    poll();
  }
  const std::function<void()> ends = [] { throw std::runtime_error("ended"); };
  const auto work = [&] {
    const PollScope ending(ends);
    poll();
  };
  CHECK_THROWS_WITH(work(), "ended");
  poll();
  CHECK(outer == 2);
  CHECK(inner == 1);
}

TEST_CASE("of nested timers of Lua the outermost counts, in its thread alone", "[lua_time]") {
  const double before = lua_seconds();
  {
    const LuaTimer outer;
    { const LuaTimer inner; }
    CHECK(lua_seconds() == before);
  }
  CHECK(lua_seconds() > before);
  double of_another = -1.0;
  std::thread([&] { of_another = lua_seconds(); }).join();
  CHECK(of_another == 0.0);
}
