// SPDX-License-Identifier: GPL-3.0-or-later
// Hashes of whole runs: all proposals, trees, paths and counts of checks of every planner and every guide. They are
// equal for each instruction set, each number of jobs, each locale and each build type: the golden file is one for all
// of them.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/image.hpp"
#include "support/manipulators.hpp"
#include "support/process.hpp"
#include "support/results.hpp"

using Json = nlohmann::json;
using trellis::test::content;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

const fs::path folder = fs::path(TRELLIS_SOURCE) / "tests/golden/determinism";

/// FNV-1a.
class Hash {
 public:
  void add(const std::string& bytes) {
    for (const char c : bytes) {
      value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    }
  }
  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << std::hex;
    out.width(16);
    out.fill('0');
    out << value_;
    return out.str();
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// The counts of a run and of its levels.
std::string counts_of(const Json& run) {
  std::string text;
  const auto add = [&](const Json& from, const char* key) { text += from.at(key).dump() + " "; };
  for (const char* key : {"status", "length", "validity_checks", "motion_checks", "path_checks"}) add(run, key);
  for (const Json& level : run.at("levels")) {
    for (const char* key :
         {"key", "name", "status", "solves", "proposals", "accepted", "nodes", "validity_checks", "motion_checks"}) {
      add(level, key);
    }
  }
  return text;
}

using Hashes = std::map<std::string, Hash>;  // by script, problem and strategy

void add_runs(const std::string& script, const Place& place, Hashes& hashes) {
  const Json document = trellis::test::with_levels(Json::parse(content(place / "all.json")));
  for (const Json& run : document.at("runs")) {
    const auto problem = run.at("problem").get<std::string>();
    const auto strategy = run.at("strategy").get<std::string>();
    Hash& hash = hashes[script + " / " + problem + " / " + strategy];
    hash.add(counts_of(run));
    std::string directory = strategy;  // as results/directories.cpp writes it
    for (char& c : directory) {
      if (c == ' ') c = '-';
    }
    const std::string at =
        "samples/" + problem + "/" + directory + "/seed-" + std::to_string(run.at("seed").get<int>()) + "/";
    for (const std::string file : {"samples.csv", "expansions.csv", "path.csv"}) {
      REQUIRE(fs::exists(place / (at + file)));
      hash.add(content(place / (at + file)));
    }
  }
}

/// Runs every script in an environment.
std::string hashes_of(const Place& place, const std::string& environment, const std::string& options) {
  Hashes hashes;
  for (const std::string script : {"planar", "driven", "arm", "manipulator", "team"}) {
    fs::remove_all(place / "samples");
    const auto outcome =
        place.shell(environment + " $T run " + script + ".lua --quiet --json all.json --samples samples " + options);
    INFO(environment << " " << script << "\n" << outcome.err);
    REQUIRE(outcome.status == 0);
    add_runs(script, place, hashes);
  }
  std::string text;
  for (const auto& [name, hash] : hashes) text += hash.text() + "  " + name + "\n";
  return text;
}

/// The scripts, and the library and the models that they use.
void prepare(const Place& place) {
  for (const std::string script : {"planar", "driven", "arm", "manipulator", "team"}) {
    fs::copy_file(folder / (script + ".lua"), place / (script + ".lua"));
  }
  place.script("six.urdf", trellis::test::six_joints);
  place.script("six.srdf", trellis::test::six_joints_srdf);
  place.script("solve.lua",
               "return experiment { problems = scenes.simple_passage(), strategies = { rrt_connect {} }, seeds = 3, "
               "measure = false }\n");
  REQUIRE(place.run({"run", "solve.lua", "--quiet", "--learn", "paths.db", "--novelty", "0"}).status == 0);
  for (const auto& [split, count] : {std::pair("train", 4), std::pair("validation", 1)}) {
    const fs::path data = fs::path(place / "data/gaps") / split;
    fs::create_directories(data);
    for (int i = 0; i < count; ++i) {
      const std::size_t gap = 5U + 9U * static_cast<std::size_t>(i);
      trellis::test::write_image((data / (std::to_string(i) + ".png")).string(), 40, 40,
                                 [&](std::size_t column, std::size_t row) {
                                   return column >= 18 && column < 22 && (row < gap || row >= gap + 6);
                                 });
    }
  }
  REQUIRE(place.run({"experience", "--data", "data", "--out", "cells.model", "--samples", "100", "--quiet"}).status ==
          0);
  REQUIRE(place
              .run({"experience", "--search", "--data", "data", "--out", "searches.model", "--cells", "20", "--rounds",
                    "2", "--samples", "20", "--quiet"})
              .status == 0);
}

/// Whether the processor has the instruction set.
bool has_kernel(const Place& place, const std::string& name) {
  place.script("tiny.lua", "return rrt {}, scenes.cup()\n");
  return place.shell("TRELLIS_KERNEL=" + name + " $T run tiny.lua --quiet").status == 0;
}

/// Compiles a locale into the folder; false where the system has no sources of locales.
bool make_locale(const Place& place, const std::string& name) {
  return place.shell("mkdir -p locale && localedef -i " + name + " -f UTF-8 locale/" + name + ".UTF-8").status == 0;
}

}  // namespace

TEST_CASE("whole runs of every planner and guide have the same hashes on every instruction set and in every build",
          "[determinism][slow]") {
  const Place place;
  prepare(place);
  const std::string found = hashes_of(place, "", "--jobs 2");
  const fs::path golden = folder / "hashes.txt";
  if (std::getenv("TRELLIS_UPDATE_GOLDEN") != nullptr) {  // NOLINT(concurrency-mt-unsafe)
    std::ofstream(golden) << found;
  }
  CHECK(found == content(golden));
  for (const std::string kernel : {"baseline", "avx2", "avx512"}) {
    if (!has_kernel(place, kernel)) {
      WARN("skipped: this processor has no " << kernel);
      continue;
    }
    INFO(kernel);
    CHECK(hashes_of(place, "TRELLIS_KERNEL=" + kernel, "--jobs 1") == found);
  }
  for (const std::string locale : {"tr_TR", "de_DE"}) {
    if (!make_locale(place, locale)) {
      WARN("skipped: the locale " << locale << " cannot be made");
      continue;
    }
    INFO(locale);
    CHECK(hashes_of(place, "LOCPATH=$PWD/locale LC_ALL=" + locale + ".UTF-8", "--jobs 2") == found);
  }
}

TEST_CASE("every planner and every guide has a hash", "[determinism]") {
  const Place place;
  std::string scripts;
  for (const std::string script : {"planar", "driven", "arm", "manipulator", "team"})
    scripts += content(folder / (script + ".lua"));
  std::istringstream help(place.run({"help"}).out);
  std::size_t count = 0;
  bool inside = false;
  for (std::string line; std::getline(help, line);) {
    if (line.ends_with(":") && !line.starts_with(" ")) inside = line == "planners:" || line == "guides:";
    const bool entry = inside && line.starts_with("  ") && line.size() > 2 && line[2] != ' ';
    if (!entry) continue;
    const std::string word = line.substr(2, line.find(' ', 2) - 2);
    INFO(word);
    const bool used = scripts.find(word + " {") != std::string::npos || scripts.find(word + "(") != std::string::npos;
    CHECK(used);
    ++count;
  }
  CHECK(count > 30);
}

TEST_CASE("an instruction set that the processor does not have is an error") {
  const Place place;
  place.script("tiny.lua", "return rrt {}, scenes.cup()\n");
  const auto outcome = place.shell("TRELLIS_KERNEL=mmx $T run tiny.lua");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("TRELLIS_KERNEL: this processor has the instruction sets baseline") != std::string::npos);
}
