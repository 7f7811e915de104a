// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/store/records.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include <dsl/command/provenance.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/errors.hpp>
#include <trellis/base/input_file.hpp>
#include <trellis/base/version.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/pictures/scenery.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/files.hpp>
#include <trellis/results/records.hpp>
#include <trellis/results/run_json.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis::command {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t largest_file = std::size_t{4} << 30U;

std::string in(const std::string& folder, const char* name) { return (std::filesystem::path(folder) / name).string(); }

[[noreturn]] void fail(const std::string& path, int reason) {
  throw Error(fmt::format("cannot write '{}': {}; the records before remain, and the same command continues", path,
                          std::strerror(reason)));  // NOLINT(concurrency-mt-unsafe)
}

/// Returns the first name whose hash differs, "" for none.
std::string first_difference(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b) {
  for (const auto& [name, hash] : a) {
    const auto other = b.find(name);
    if (other == b.end() || other->second != hash) return name;
  }
  for (const auto& [name, hash] : b) {
    if (!a.contains(name)) return name;
  }
  return "";
}

std::uint64_t number_of(std::string_view text, std::string_view whole) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value == 0) {
    throw Error(fmt::format("--shard: '{}' is not I/N, two integers of at least 1, as 2/10", whole));
  }
  return value;
}

}  // namespace

std::string RunKey::text() const { return fmt::format("'{}' on '{}', seed {}", strategy, problem, seed); }

Shard Shard::parse(const std::string& text) {
  if (text.empty()) return {};
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) throw Error(fmt::format("--shard: '{}' is not I/N, as 2/10", text));
  const std::string_view whole = text;
  const Shard shard{number_of(whole.substr(0, slash), whole), number_of(whole.substr(slash + 1), whole)};
  if (shard.index > shard.count) {
    throw Error(fmt::format("--shard: {} is more than the {} shards; the first is 1/{}", shard.index, shard.count,
                            shard.count));
  }
  return shard;
}

std::string Shard::text() const { return fmt::format("{}/{}", index, count); }

namespace {

Scenery scenery_from(const Json& json) {
  const auto text = [&](const char* name) { return json::lines(json.at(name).get_ref<const Json::array_t&>()); };
  return {text("worlds"), text("robots"), text("scenes")};
}

}  // namespace

Manifest Manifest::read(const std::string& folder) {
  const std::string path = in(folder, "manifest.json");
  try {
    const Json json = Json::parse(dsl::read_file(path, largest_file));
    return {json.at("version").get<std::string>(),
            json.at("script").get<std::string>(),
            json.at("script_hash").get<std::string>(),
            json.at("files").get<std::map<std::string, std::string>>(),
            json.at("worlds").get<std::map<std::string, std::string>>(),
            json.at("options").get<std::string>(),
            Shard::parse(json.at("shard").get<std::string>()),
            json.at("experiment").dump(),
            scenery_from(json.at("scenery"))};
  } catch (const Json::exception&) {
    throw Error(
        fmt::format("{}: this is no manifest of this version of trellis ({}); name another folder, or start "
                    "again with --restart",
                    path, trellis::version()));
  }
}

bool Manifest::exists(const std::string& folder) { return std::filesystem::exists(in(folder, "manifest.json")); }

void Manifest::write(const std::string& folder) const {
  const Json json = {{"version", version},
                     {"script", script},
                     {"script_hash", script_hash},
                     {"files", files},
                     {"worlds", worlds},
                     {"options", options},
                     {"shard", shard.text()},
                     {"experiment", Json::parse(experiment)},
                     {"commit", commit()},
                     {"machine", machine()},
                     {"scenery",
                      {{"worlds", Json::parse(scenery.worlds)},
                       {"robots", Json::parse(scenery.robots)},
                       {"scenes", Json::parse(scenery.scenes)}}}};
  write_file(in(folder, "manifest.json"), json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n');
}

std::string Manifest::difference(const Manifest& other, bool shards) const {
  if (version != other.version)
    return fmt::format("the version of trellis differs ({} and {})", version, other.version);
  if (script_hash != other.script_hash) return "the content of the script differs";
  if (const std::string file = first_difference(files, other.files); !file.empty()) {
    return fmt::format("the content of '{}', which the script reads, differs", file);
  }
  if (options != other.options) return fmt::format("the options differ ({} and {})", options, other.options);
  if (shards && shard.text() != other.shard.text()) {
    return fmt::format("the shard differs ({} and {})", shard.text(), other.shard.text());
  }
  if (experiment != other.experiment) return "the experiment differs";
  const std::string world = first_difference(worlds, other.worlds);
  return world.empty() ? "" : fmt::format("the world or the robot of problem '{}' differs", world);
}

ScriptFiles::ScriptFiles(dsl::SessionOptions& session)
    : files_(std::make_shared<std::map<std::string, std::string>>()) {
  session.watch = [files = files_](const std::string& name, const std::string& path) {
    (*files)[name] = file_hash(path);
  };
}

Manifest ScriptFiles::manifest(const std::string& script, const std::string& options, Shard shard,
                               const Experiment& experiment) const {
  std::map<std::string, std::string> worlds;
  for (const Problem& problem : experiment.problems) {
    worlds[utf8(problem.name)] = fmt::format("{:016x}{:016x}", world_hash(*problem.scene), robot_hash(*problem.scene));
  }
  return {
      std::string(version()), script, file_hash(script), *files_, worlds, options, shard, experiment_line(experiment),
      scenery_of(experiment)};
}

RunList::RunList(const std::string& experiment) {
  const Json json = Json::parse(experiment);
  for (const Json& problem : json.at("problems")) problems_.push_back(problem.at("name").get<std::string>());
  for (const Json& strategy : json.at("strategies")) strategies_.push_back(strategy.at("name").get<std::string>());
  for (const Json& seed : json.at("seeds")) seeds_.push_back(seed.get<std::uint64_t>());
  for (std::size_t i = 0; i < problems_.size(); ++i) problem_.emplace(problems_[i], i);
  for (std::size_t i = 0; i < strategies_.size(); ++i) strategy_.emplace(strategies_[i], i);
  for (std::size_t i = 0; i < seeds_.size(); ++i) seed_.emplace(seeds_[i], i);
}

RunKey RunList::key(std::size_t run) const {
  const std::size_t seeds = seeds_.size();
  return {problems_[run / seeds / strategies_.size()], strategies_[run / seeds % strategies_.size()],
          seeds_[run % seeds]};
}

std::optional<std::size_t> RunList::find(const RunKey& key) const {
  const auto problem = problem_.find(key.problem);
  const auto strategy = strategy_.find(key.strategy);
  const auto seed = seed_.find(key.seed);
  if (problem == problem_.end() || strategy == strategy_.end() || seed == seed_.end()) return std::nullopt;
  return (problem->second * strategies_.size() + strategy->second) * seeds_.size() + seed->second;
}

std::vector<std::size_t> cells_of(const std::string& experiment, const Shard& shard) {
  const Json json = Json::parse(experiment);
  const std::size_t strategies = json.at("strategies").size();
  const std::size_t seeds = json.at("seeds").size();
  std::vector<std::size_t> cells;
  for (std::size_t i = 0; i < json.at("problems").size() * strategies * seeds; ++i) {
    const std::size_t problem = i / seeds / strategies;
    if ((problem * seeds + i % seeds) % shard.count == shard.index - 1) cells.push_back(i);
  }
  return cells;
}

std::uint64_t each_record(const std::string& path, const std::function<void(const RecordLine&)>& visit) {
  InputFile file(path, largest_file);
  ErrorList errors;
  std::string text;  // what follows the complete lines
  std::uint64_t complete = 0;
  std::size_t number = 0;
  for (std::string block; file.next(block) && !block.empty();) {
    const std::size_t searched = text.size();
    text += block;
    std::size_t begin = 0;
    for (std::size_t end = text.find('\n', searched); end != std::string::npos; end = text.find('\n', begin)) {
      RecordLine line{{}, std::string_view(text).substr(begin, end - begin), ++number, complete + begin};
      begin = end + 1;
      try {
        const Json json = Json::parse(line.text);
        line.key = {json.at("problem").get<std::string>(), json.at("strategy").get<std::string>(),
                    json.at("seed").get<std::uint64_t>()};
        visit(line);
      } catch (const Json::exception&) {
        errors.add(Error(fmt::format(
            "{}:{}: this is no record of a run; delete the line, and the same command runs it again", path, number)));
      } catch (const Error& error) {
        errors.add(error);
      }
    }
    text.erase(0, begin);
    complete += begin;
  }
  if (!file.fault().empty()) throw Error(fmt::format("cannot read '{}': {}", path, file.fault()));
  errors.raise();
  return complete;
}

namespace {

/// Reads a part of an open file.
std::string read_part(int file, std::uint64_t offset, std::size_t length, const std::string& path) {
  std::string text(length, '\0');
  for (std::size_t done = 0; done < length;) {
    const ssize_t got = ::pread(file, text.data() + done, length - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      const std::string reason = got < 0 ? std::strerror(errno) : "it was shortened meanwhile";  // NOLINT
      throw Error(fmt::format("cannot read '{}': {}", path, reason));
    }
    done += static_cast<std::size_t>(got);
  }
  return text;
}

}  // namespace

StoredRuns::StoredRuns(const std::string& experiment) : runs_(experiment), places_(runs_.size()) {}

StoredRuns::~StoredRuns() {
  for (const int file : open_) {
    if (file >= 0) ::close(file);
  }
}

void StoredRuns::add(const std::string& path) {
  const auto number = static_cast<std::uint32_t>(files_.size());
  files_.push_back(path);
  open_.push_back(-1);
  std::set<RunKey> unknown;
  each_record(path, [&](const RecordLine& record) {
    const auto twice = [&] {
      return Error(
          fmt::format("{}:{}: {} is there twice; delete one of the lines", path, record.number, record.key.text()));
    };
    const auto run = runs_.find(record.key);
    if (!run) {
      if (!unknown.insert(record.key).second) throw twice();
      ++others_;
      return;
    }
    Place& place = places_[*run];
    if (place.length == 0) {
      place = {record.offset, static_cast<std::uint32_t>(record.text.size()), number};
    } else if (place.file == number) {
      throw twice();
    } else if (without_times(line(*run)) != without_times(std::string(record.text))) {
      throw Error(
          fmt::format("{}: {} differs from its record in a folder before; they ran on different programs or "
                      "scenes",
                      path, record.key.text()));
    }
  });
}

std::string StoredRuns::line(std::size_t run) const {
  constexpr std::size_t most_open = 200;  // of 1024 that a process may have
  const Place& place = places_.at(run);
  int& file = open_[place.file];
  if (file < 0) {
    if (opened_ >= most_open) {
      for (int& other : open_) {
        if (other >= 0) ::close(std::exchange(other, -1));
      }
      opened_ = 0;
    }
    file = ::open(files_[place.file].c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) {
      throw Error(fmt::format("cannot read '{}': {}", files_[place.file], std::strerror(errno)));  // NOLINT
    }
    ++opened_;
  }
  return read_part(file, place.offset, place.length, files_[place.file]);
}

std::string utf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

std::string file_hash(const std::string& path) {
  InputFile file(path, std::numeric_limits<std::uintmax_t>::max());
  std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a
  for (std::string block; file.next(block) && !block.empty();) {
    for (const char c : block) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  if (!file.fault().empty()) throw Error(fmt::format("cannot read '{}': {}", path, file.fault()));
  return fmt::format("{:016x}", hash);
}

void write_results(const std::string& folder, const Manifest& manifest,
                   const std::function<std::string(std::size_t run)>& line) {
  FileWriter runs(in(folder, "runs.jsonl"));
  FileWriter document(in(folder, "results.json"));
  FileWriter table(in(folder, "runs.csv"));
  RunsDocument results;
  document.write(results.begin(manifest.script, manifest.experiment, manifest.scenery));
  table.write(runs_csv_header());
  for (const std::size_t run : cells_of(manifest.experiment, manifest.shard)) {
    const std::string record = line(run);
    runs.write(record + '\n');
    document.write(results.add(read_run(record)));
    table.write(runs_csv_row(record));
  }
  document.write(results.end());
  for (FileWriter* file : {&runs, &document, &table}) file->publish();
}

void require_same(const std::string& folder, const Manifest& manifest) {
  if (!Manifest::exists(folder)) return;
  const std::string difference = Manifest::read(folder).difference(manifest, true);
  if (difference.empty()) return;
  throw Error(fmt::format(
      "--out: '{}' holds other runs: {}; name another folder, or start again with --restart, which deletes their "
      "records",
      folder, difference));
}

RecordFile::RecordFile(const std::string& folder, const char* name, bool restart) : path_(in(folder, name)) {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) fail(path_, errno);
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    ::close(file_);
    throw Error(fmt::format("'{}' is in use by another process; wait for its end, or use another folder", path_));
  }
  try {
    if (restart && ::ftruncate(file_, 0) != 0) fail(path_, errno);
    size_ = each_record(path_, [&](const RecordLine& record) {
      const bool known = places_.contains(record.key);
      places_.insert_or_assign(record.key, Place{record.offset, record.text.size()});
      // Without a strategy it is of a whole problem, and a later record replaces it.
      if (!known || record.key.strategy.empty()) return;
      throw Error(
          fmt::format("{}:{}: {} is there twice; delete one of the lines", path_, record.number, record.key.text()));
    });
    if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) fail(path_, errno);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

RecordFile::~RecordFile() { ::close(file_); }

std::optional<std::string> RecordFile::find(const RunKey& key) const {
  const std::scoped_lock lock(mutex_);
  const auto stored = places_.find(key);
  if (stored == places_.end()) return std::nullopt;
  return read_part(file_, stored->second.offset, stored->second.length, path_);
}

void RecordFile::append(const RunKey& key, const std::string& line) {
  const std::scoped_lock lock(mutex_);
  int reason = write_all(file_, line + '\n');
  if (reason == 0 && ::fdatasync(file_) != 0 && errno != EINVAL) reason = errno;
  if (reason != 0) {
    // The next start removes what this cannot.
    static_cast<void>(::ftruncate(file_, static_cast<off_t>(size_)));
    fail(path_, reason);
  }
  places_.insert_or_assign(key, Place{size_, line.size()});
  size_ += line.size() + 1;
}

}  // namespace trellis::command
