// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <trellis/base/error.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/samples.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/csv.hpp>
#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/worlds.hpp"

using namespace trellis;
namespace fs = std::filesystem;

namespace {

std::size_t entries(const test::Folder& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

std::vector<std::vector<std::string>> table(const fs::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(read(path));
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back(1);
    for (const char c : line) {
      if (c == ',') {
        rows.back().emplace_back();
      } else {
        rows.back().back() += c;
      }
    }
  }
  return rows;
}

double number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  REQUIRE(error == std::errc());
  REQUIRE(end == text.data() + text.size());
  return value;
}

void check_rows(const std::vector<std::vector<std::string>>& rows, std::size_t& next, const LevelRecord& record,
                const std::string& role, const Configurations& samples, std::size_t columns) {
  for (std::size_t i = 0; i < samples.size(); ++i, ++next) {
    REQUIRE(next < rows.size());
    const auto& row = rows[next];
    REQUIRE(row.size() == 4 + columns);
    const bool accepted = role == "tree" || record.search.fates[i] != Fate::rejected;
    const bool head = row[0] == std::to_string(record.level) && row[1] == role && row[2] == std::to_string(i) &&
                      row[3] == (accepted ? "1" : "0");
    REQUIRE(head);
    for (std::size_t j = 0; j < columns; ++j) {
      if (j < samples.dimension()) {
        REQUIRE(number(row[4 + j]) == samples[i][j]);  // to the last bit
      } else {
        REQUIRE(row[4 + j].empty());
      }
    }
  }
}

}  // namespace

TEST_CASE("samples come back as they were", "[report][samples]") {
  const auto [experiment, result] = fixture::passage();
  const test::Folder folder;
  write_samples(result, folder.path().string());
  for (const auto& run : result.runs) {
    const fs::path place = folder.path() / run.problem / run.strategy / ("seed-" + std::to_string(run.seed));
    const auto rows = table(place / "samples.csv");
    REQUIRE(rows.front() == std::vector<std::string>{"level", "role", "index", "accepted", "q1", "q2", "q3"});
    std::size_t next = 1;
    for (const auto& level : run.levels) {
      check_rows(rows, next, level.record, "tree", level.record.search.nodes, 3);
      check_rows(rows, next, level.record, "expansion", level.record.search.proposals, 3);
    }
    CHECK(next == rows.size());

    // The triples: the node, the proposal, which samples.csv has, and the result.
    const auto expansions = table(place / "expansions.csv");
    REQUIRE(expansions.front() == std::vector<std::string>{"level", "index", "piece", "fate", "node", "added"});
    std::size_t row = 1;
    for (const auto& level : run.levels) {
      const Search& search = level.record.search;
      const auto text = [](std::uint32_t node) { return node == no_node ? "" : std::to_string(node); };
      for (std::size_t i = 0; i < search.proposals.size(); ++i, ++row) {
        REQUIRE(row < expansions.size());
        const std::string fate = search.fates[i] == Fate::rejected   ? "rejected"
                                 : search.fates[i] == Fate::advanced ? "advanced"
                                                                     : "reached";
        REQUIRE(expansions[row] == std::vector<std::string>{std::to_string(level.record.level), std::to_string(i), "0",
                                                            fate, text(search.near[i]), text(search.added[i])});
      }
    }
    CHECK(row == expansions.size());

    const auto path = table(place / "path.csv");
    REQUIRE(path.front() == std::vector<std::string>{"q1", "q2", "q3"});
    REQUIRE(path.size() == 1 + run.run.path.size());
    for (std::size_t i = 0; i < run.run.path.size(); ++i) {
      for (std::size_t j = 0; j < 3; ++j) CHECK(number(path[1 + i][j]) == run.run.path[i][j]);
    }
  }
}

TEST_CASE("expansions of a driven robot have the controls of each motion", "[report][samples]") {
  for (const std::string extend : {"controls", "curves"}) {
    const Problem problem = test::driven(test::cup_problem());
    ExperimentResult result;
    result.runs.push_back(
        run_cell("it", StrategySpec(PlannerSpec::make("kinodynamic_rrt", {{"extend", extend}})), problem, 2));
    const test::Folder folder;
    write_samples(result, folder.path().string());
    const auto rows = table(folder.path() / "cup-by-unicycle1" / "it" / "seed-2" / "expansions.csv");
    REQUIRE(rows.front() == std::vector<std::string>{"level", "index", "piece", "fate", "node", "added", "u1", "u2",
                                                     "duration", "driven"});
    const Search& search = result.runs.front().levels.front().record.search;
    const ControlRecord& record = search.controls;
    REQUIRE(rows.size() == 1 + record.steps.size());
    std::size_t row = 1;
    for (std::size_t i = 0; i < record.ends.size(); ++i) {
      for (std::size_t k = record.begin_of(i); k < record.ends[i]; ++k, ++row) {
        CHECK(rows[row][1] == std::to_string(i));
        CHECK(rows[row][2] == std::to_string(k - record.begin_of(i)));
        CHECK(rows[row][4] == std::to_string(search.near[i]));
        for (std::size_t j = 0; j < 2; ++j) CHECK(number(rows[row][6 + j]) == record.controls[k][j]);
        CHECK(number(rows[row][8]) == 0.1 * record.steps[k]);
        CHECK(number(rows[row][9]) == 0.1 * record.driven[k]);
      }
    }
  }
}

TEST_CASE("samples are the same bytes twice, and may be written over", "[report][samples]") {
  const auto [experiment, result] = fixture::passage();
  const test::Folder folder;
  write_samples(result, folder.path().string());
  const fs::path file = folder.path() / "simple_passage" / "nested" / "seed-3" / "samples.csv";
  const std::string first = read(file);
  write_samples(result, folder.path().string());
  CHECK(read(file) == first);
}

TEST_CASE("names that are no file names get directories of their own", "[report][samples]") {
  ExperimentResult result;
  for (const char* problem : {"a/b", "a:b", "..", ""}) result.runs.push_back(fixture::plain_run(problem, 1, true));
  const test::Folder folder;
  write_samples(result, folder.path().string());
  for (const char* directory : {"a-b", "a-b-2", "-.", "-"}) {
    CAPTURE(directory);
    CHECK(fs::exists(folder.path() / directory / "rrt" / "seed-1" / "path.csv"));
  }
  CHECK(entries(folder) == 4);
}

TEST_CASE("a file is written whole or not at all", "[report][files]") {
  const test::Folder folder;
  const fs::path file = folder.path() / "out.json";
  write_file(file.string(), "first");
  CHECK(read(file) == "first");
  write_file(file.string(), "second, longer");
  CHECK(read(file) == "second, longer");
  CHECK(entries(folder) == 1);

  SECTION("a missing folder") {
    const std::string path = (folder.path() / "missing" / "out.json").string();
    CHECK_THROWS_WITH(write_file(path, "x"), "cannot write '" + path + "': No such file or directory");
    CHECK(entries(folder) == 1);
  }
  SECTION("a folder at the file's path") {
    const fs::path taken = folder.path() / "taken";
    fs::create_directory(taken);
    CHECK_THROWS_WITH(write_file(taken.string(), "x"), "cannot write '" + taken.string() + "': Is a directory");
    CHECK(entries(folder) == 2);
  }
  SECTION("a file where a folder should be") {
    CHECK_THROWS_AS(write_file((file / "out.json").string(), "x"), Error);
    const auto [experiment, result] = fixture::passage();
    CHECK_THROWS_AS(write_samples(result, file.string()), Error);
    CHECK(entries(folder) == 1);
    CHECK(read(file) == "second, longer");
  }
  SECTION("a folder that may not be written to") {
    if (::geteuid() != 0) {  // nothing is forbidden to root
      fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
      CHECK_THROWS_AS(write_file((folder.path() / "new").string(), "x"), Error);
      fs::permissions(folder.path(), fs::perms::owner_all);
      CHECK(entries(folder) == 1);
    }
  }
  SECTION("a link is followed") {
    const fs::path link = folder.path() / "link";
    fs::create_symlink(file, link);
    write_file(link.string(), "third");
    CHECK(fs::is_symlink(link));
    CHECK(read(file) == "third");
  }
  SECTION("a full device is an error, and stays a device") {
    if (fs::exists("/dev/full")) {
      CHECK_THROWS_WITH(write_file("/dev/full", "x"), "cannot write '/dev/full': No space left on device");
      CHECK(fs::is_character_file("/dev/full"));
    }
  }
}

TEST_CASE("a new file has the permissions that a file should have", "[report][files]") {
  const test::Folder folder;
  const mode_t before = ::umask(022);
  write_file((folder.path() / "out").string(), "x");
  ::umask(before);
  CHECK(fs::status(folder.path() / "out").permissions() ==
        (fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read | fs::perms::others_read));
}

TEST_CASE("names in CSV files are no formulas", "[report][files]") {
  CHECK(csv_text("rrt") == "rrt");
  CHECK(csv_text("a, \"b\"") == "\"a, \"\"b\"\"\"");
  CHECK(csv_text("two\nlines") == "\"two\nlines\"");
  CHECK(csv_text("=HYPERLINK(\"x\")") == "\"'=HYPERLINK(\"\"x\"\")\"");
  CHECK(csv_text("+1 better") == "\"'+1 better\"");
  CHECK(csv_text("-cmd") == "\"'-cmd\"");
  CHECK(csv_text("@SUM(A1)") == "\"'@SUM(A1)\"");
  CHECK(csv_text("\t=1") == "\"'\t=1\"");
  CHECK(csv_text("\r=1") == "\"'\r=1\"");
  // A number is no formula.
  CHECK(csv_text("-5") == "-5");
  CHECK(csv_text("-1.5e3") == "-1.5e3");
  CHECK(csv_text("a-b") == "a-b");
}
