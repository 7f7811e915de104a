// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <vector>

#include <trellis/results/facts.hpp>

/// The folder of a sweep or of a run: a manifest, and one record a run, which remain when the program is killed.
namespace trellis {
struct Experiment;
}
namespace trellis::dsl {
struct SessionOptions;
}

namespace trellis::command {

struct RunKey {
  std::string problem;
  std::string strategy;
  std::uint64_t seed = 0;
  friend bool operator<(const RunKey& a, const RunKey& b) {
    return std::tie(a.problem, a.strategy, a.seed) < std::tie(b.problem, b.strategy, b.seed);
  }
  [[nodiscard]] std::string text() const;
};

/// One of several parts of a sweep. All strategies of a problem and a seed are in one part, so that their times
/// compare.
struct Shard {
  std::uint64_t index = 1;  ///< from 1
  std::uint64_t count = 1;
  /// Parses "2/10", "" for all. \throws Error
  static Shard parse(const std::string& text);
  [[nodiscard]] std::string text() const;
};

/// The inputs that determine the runs of a sweep. Numbers that JSON rounds are stored as text.
struct Manifest {
  std::string version;      ///< of the program
  std::string script;       ///< path as given
  std::string script_hash;  ///< of the file's bytes
  /// The hashes of the modules, scenes, libraries and models that the script names, by name.
  std::map<std::string, std::string> files;
  std::map<std::string, std::string> worlds;  ///< hashes of world and robot, by problem
  std::string options;                        ///< those of the command line that change the runs
  Shard shard;
  std::string experiment;  ///< a result of experiment_line()
  Scenery scenery;         ///< not compared: `worlds` has its hashes

  /// \throws Error that names the file
  static Manifest read(const std::string& folder);
  static bool exists(const std::string& folder);
  void write(const std::string& folder) const;
  /// Returns a clause with the first difference, "" for none. Ignores the path of the script.
  [[nodiscard]] std::string difference(const Manifest& other, bool shards) const;
};

/// Collects the hashes of the files that a script names while it loads.
class ScriptFiles {
 public:
  /// Sets the session's `watch`.
  explicit ScriptFiles(dsl::SessionOptions& session);
  /// Describes the runs of a script that has loaded.
  [[nodiscard]] Manifest manifest(const std::string& script, const std::string& options, Shard shard,
                                  const Experiment& experiment) const;

 private:
  std::shared_ptr<std::map<std::string, std::string>> files_;
};

/// The runs of an experiment, by problem, strategy, seed, without a list of them.
class RunList {
 public:
  /// \param experiment  a result of experiment_line()
  explicit RunList(const std::string& experiment);
  [[nodiscard]] std::size_t size() const { return problems_.size() * strategies_.size() * seeds_.size(); }
  [[nodiscard]] RunKey key(std::size_t run) const;
  /// Returns the index of a run; none for one that the experiment does not have.
  [[nodiscard]] std::optional<std::size_t> find(const RunKey& key) const;

 private:
  std::vector<std::string> problems_;
  std::vector<std::string> strategies_;
  std::vector<std::uint64_t> seeds_;
  std::map<std::string, std::size_t> problem_;
  std::map<std::string, std::size_t> strategy_;
  std::unordered_map<std::uint64_t, std::size_t> seed_;
};

/// Returns the indices of the runs in a shard.
std::vector<std::size_t> cells_of(const std::string& experiment, const Shard& shard);

/// A line of a file of records.
struct RecordLine {
  RunKey key;
  std::string_view text;     ///< without its end; valid during the call
  std::size_t number = 0;    ///< from 1
  std::uint64_t offset = 0;  ///< of its first byte
};

/// Reads a file of records block by block, and ignores a last line without its end. Errors of `visit`, and lines that
/// are no records, do not end it; it throws them together at the end.
/// \return the length of the complete lines
/// \throws Error that names the file and the line
std::uint64_t each_record(const std::string& path, const std::function<void(const RecordLine&)>& visit);

/// The records of an experiment's runs in several files. Memory has their places alone, 16 bytes a run.
class StoredRuns {
 public:
  /// \param experiment  a result of experiment_line()
  explicit StoredRuns(const std::string& experiment);
  ~StoredRuns();
  StoredRuns(const StoredRuns&) = delete;
  StoredRuns& operator=(const StoredRuns&) = delete;

  /// Adds the records of a file. Records of one run must be equal, except for times; the first one remains.
  void add(const std::string& path);
  [[nodiscard]] const RunList& runs() const { return runs_; }
  [[nodiscard]] bool contains(std::size_t run) const { return places_[run].length > 0; }
  /// The number of added records of runs that the experiment does not have.
  [[nodiscard]] std::size_t others() const { return others_; }
  /// Reads the record of a run.
  [[nodiscard]] std::string line(std::size_t run) const;

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t length = 0;  ///< 0: there is no record
    std::uint32_t file = 0;
  };
  RunList runs_;
  std::vector<Place> places_;
  std::vector<std::string> files_;
  mutable std::vector<int> open_;  ///< file descriptors by file, -1 for a closed one
  mutable std::size_t opened_ = 0;
  std::size_t others_ = 0;
};

/// Returns a text as JSON stores it: bytes that are no UTF-8 become U+FFFD.
std::string utf8(const std::string& text);

/// Returns a hash of a file's bytes, 16 hexadecimal digits. Reads it block by block: a library may be larger than the
/// memory. \throws Error where the file cannot be read
std::string file_hash(const std::string& path);

/// Stores the results of a complete sweep: the records in the order of the runs, results.json and runs.csv.
/// \param line  returns the record of a run
void write_results(const std::string& folder, const Manifest& manifest,
                   const std::function<std::string(std::size_t run)>& line);

/// Checks that a folder has no manifest, or an equal one. \throws Error that names the difference
void require_same(const std::string& folder, const Manifest& manifest);

/// A file of records, locked against other processes.
class RecordFile {
 public:
  /// Opens or creates the file, and removes an incomplete last line.
  /// \param restart  removes all records
  RecordFile(const std::string& folder, const char* name, bool restart);
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// Not while another thread may append.
  [[nodiscard]] bool contains(const RunKey& key) const { return places_.contains(key); }
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  /// Returns the record of a key, if there is one. Thread-safe.
  [[nodiscard]] std::optional<std::string> find(const RunKey& key) const;
  /// Appends a record, or one that replaces the key's, and syncs it. A failure leaves the records before it.
  /// Thread-safe. \throws Error
  void append(const RunKey& key, const std::string& line);

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::size_t length = 0;
  };
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::map<RunKey, Place> places_;
  mutable std::mutex mutex_;
};

}  // namespace trellis::command
