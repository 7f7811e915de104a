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
#include <trellis/report/files.hpp>
#include <trellis/report/records.hpp>
#include <trellis/report/report.hpp>
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

void remove_times(Json& json) {
  if (json.is_object()) {
    for (const char* name : {"time_s", "cpu_s", "path_cpu_s"}) json.erase(std::string(name));
  }
  if (json.is_structured()) {
    for (Json& part : json) remove_times(part);
  }
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
            json.at("experiment").dump()};
  } catch (const Json::exception&) {
    throw Error(
        fmt::format("{}: this is no manifest of this version of trellis ({}); name another folder, or start "
                    "again with --restart",
                    path, trellis::version()));
  }
}

bool Manifest::exists(const std::string& folder) { return std::filesystem::exists(in(folder, "manifest.json")); }

void Manifest::write(const std::string& folder) const {
  const Json json = {{"version", version},         {"script", script},
                     {"script_hash", script_hash}, {"files", files},
                     {"worlds", worlds},           {"options", options},
                     {"shard", shard.text()},      {"experiment", Json::parse(experiment)},
                     {"commit", commit()},         {"machine", machine()}};
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
  return {std::string(version()),     script, file_hash(script), *files_, worlds, options, shard,
          experiment_line(experiment)};
}

std::vector<RunKey> keys_of(const std::string& experiment) {
  const Json json = Json::parse(experiment);
  std::vector<RunKey> keys;
  for (const Json& problem : json.at("problems")) {
    for (const Json& strategy : json.at("strategies")) {
      for (const Json& seed : json.at("seeds")) {
        keys.push_back(
            {problem.at("name").get<std::string>(), strategy.at("name").get<std::string>(), seed.get<std::uint64_t>()});
      }
    }
  }
  return keys;
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

Records parse_records(const std::string& text, const std::string& file, std::size_t& complete) {
  Records records;
  ErrorList errors;
  complete = 0;
  std::size_t number = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', complete)) {
    std::string line = text.substr(complete, end - complete);
    complete = end + 1;
    ++number;
    try {
      const Json json = Json::parse(line);
      const RunKey key{json.at("problem").get<std::string>(), json.at("strategy").get<std::string>(),
                       json.at("seed").get<std::uint64_t>()};
      // Without a strategy it is of a whole problem, and a later record replaces it.
      const bool known = records.contains(key);
      records.insert_or_assign(key, std::move(line));
      if (known && !key.strategy.empty()) {
        errors.add(Error(fmt::format("{}:{}: {} is there twice; delete one of the lines", file, number, key.text())));
      }
    } catch (const Json::exception&) {
      errors.add(Error(fmt::format(
          "{}:{}: this is no record of a run; delete the line, and the same command runs it again", file, number)));
    }
  }
  errors.raise();
  return records;
}

std::string without_times(const std::string& line) {
  Json json = Json::parse(line);
  remove_times(json);
  return json.dump();
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

void write_results(const std::string& folder, const Manifest& manifest, const Records& records) {
  std::vector<std::string> lines;
  std::string text;
  const std::vector<RunKey> keys = keys_of(manifest.experiment);
  for (const std::size_t cell : cells_of(manifest.experiment, manifest.shard)) {
    lines.push_back(records.at(keys[cell]));
    text += lines.back() + '\n';
  }
  write_file(in(folder, "runs.jsonl"), text);
  write_file(in(folder, "results.json"), runs_document(manifest.script, manifest.experiment, lines));
  write_file(in(folder, "runs.csv"), runs_csv(lines));
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
    records_ = parse_records(dsl::read_file(path_, largest_file), path_, size_);
    if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) fail(path_, errno);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

RecordFile::~RecordFile() { ::close(file_); }

std::optional<std::string> RecordFile::find(const RunKey& key) const {
  const std::scoped_lock lock(mutex_);
  const auto stored = records_.find(key);
  return stored != records_.end() ? std::optional(stored->second) : std::nullopt;
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
  size_ += line.size() + 1;
  records_.insert_or_assign(key, line);
}

}  // namespace trellis::command
