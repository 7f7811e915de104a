// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/figures.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/pictures/packed_run.hpp>
#include <trellis/pictures/scenery.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

/// A folder of its own in the system's temporary one, removed with this object.
class TemporaryFolder {
 public:
  /// \throws Error where none can be made.
  TemporaryFolder() {
    std::error_code fault;
    path_ = (fs::temp_directory_path(fault) / "trellis-XXXXXX").string();
    if (fault || ::mkdtemp(path_.data()) == nullptr) {
      throw Error(fmt::format("no temporary folder '{}' can be made: {}", path_,
                              fault ? fault.message() : std::generic_category().message(errno)));
    }
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// What a process printed, and how it ended.
struct Ended {
  int status = 0;  ///< of its exit; negative: it was not started, or a signal ended it
  std::string output;
  std::string errors;
};

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Runs a program, found as a shell finds it, without an input.
/// \param path  of Python's modules, before those that the user has; "": none
Ended run_program(const std::vector<std::string>& words, const std::string& path) {
  const TemporaryFolder folder;
  const std::string output = (fs::path(folder.path()) / "output").string();
  const std::string errors = (fs::path(folder.path()) / "errors").string();
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  constexpr mode_t mode = 0600;
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), flags, mode);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), flags, mode);
  std::vector<std::string> own = words;
  std::vector<char*> arguments;
  arguments.reserve(own.size() + 1);
  for (std::string& word : own) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<std::string> variables;
  const std::string key = "PYTHONPATH=";
  std::string paths = key + path;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string one = *variable;
    if (!one.starts_with(key)) {
      variables.push_back(one);
    } else if (one.size() > key.size()) {
      paths += (path.empty() ? "" : ":") + one.substr(key.size());
    }
  }
  if (paths.size() > key.size()) variables.push_back(paths);
  std::vector<char*> environment;
  environment.reserve(variables.size() + 1);
  for (std::string& variable : variables) environment.push_back(variable.data());
  environment.push_back(nullptr);
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, own.front().c_str(), &actions, nullptr, arguments.data(), environment.data());
  ::posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return {-1, "", std::generic_category().message(failed)};
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(output), text_of(errors)};
}

/// Returns the folder of the Python package, "" without: beside this program, or as installed.
std::string package() {
  std::error_code fault;
  const fs::path program = fs::read_symlink("/proc/self/exe", fault);
  if (fault) return "";
  for (const char* place : {"python", "../python", "../share/trellis/python"}) {
    const fs::path folder = program.parent_path() / place;
    if (fs::exists(folder / "trellis" / "figures" / "__main__.py", fault)) return folder.lexically_normal().string();
  }
  return "";
}

/// Returns a Python that has what figures need, "" without: TRELLIS_PYTHON if it is set, else the first python3.
std::string interpreter() {
  std::vector<std::string> candidates = {"python3", "/usr/bin/python3"};
  if (const char* given = std::getenv("TRELLIS_PYTHON"); given != nullptr && *given != '\0') candidates = {given};
  for (const std::string& candidate : candidates) {
    constexpr const char* question =
        "import importlib.util as u, sys\n"
        "sys.exit(any(u.find_spec(name) is None for name in ('numpy', 'matplotlib', 'pandas')))";
    if (run_program({candidate, "-c", question}, "").status == 0) return candidate;
  }
  return "";
}

/// Runs the package with these arguments, and returns what it printed.
/// \param own  a document that the user has not named, so that no message names it; "": none
std::string run_package(const std::vector<std::string>& arguments, const std::string& own = "") {
  const std::string modules = package();
  if (modules.empty()) {
    throw Error("figures: the Python package 'trellis' is not beside this program: build or install all of Trellis");
  }
  const std::string python = interpreter();
  if (python.empty()) {
    throw Error(
        "figures are drawn by Python 3 with matplotlib and pandas: install python3-matplotlib and python3-pandas "
        "(Debian), or set TRELLIS_PYTHON to a Python that has them");
  }
  std::vector<std::string> words = {python, "-m", "trellis.figures"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const Ended ended = run_program(words, modules);
  if (ended.status == 0) return ended.output;
  // Of a fault of Python the last line says what it was.
  std::string text = ended.errors;
  while (text.ends_with('\n')) text.pop_back();
  if (ended.status != 1 || text.starts_with("Traceback")) text = text.substr(text.rfind('\n') + 1);
  if (!own.empty() && text.starts_with(own)) text.replace(0, own.size(), "figures");
  throw Error(text.empty() ? "figures: Python was ended before they were drawn" : text);
}

/// Writes the document and the samples of results into a folder, and returns the document's name.
std::string write_results(const Experiment& experiment, const ExperimentResult& result, const std::string& folder) {
  ExperimentFacts facts = facts_of(experiment, result);
  facts.scenery = scenery_of(experiment);
  facts.samples = "samples";
  write_packed_samples(experiment, result, (fs::path(folder) / facts.samples).string());
  std::string document = (fs::path(folder) / "results.json").string();
  write_file(document, report_json(facts, summarise(facts)), Flush::none);
  return document;
}

}  // namespace

std::string draw_figures(const std::vector<std::string>& documents, const std::string& folder,
                         const std::string& figure, const std::string& baseline, bool by_name) {
  std::vector<std::string> arguments = documents;
  arguments.insert(arguments.end(), {"--out", folder});
  if (!figure.empty()) arguments.insert(arguments.end(), {"--figure", figure});
  if (!baseline.empty()) arguments.insert(arguments.end(), {"--baseline", baseline});
  if (by_name) arguments.emplace_back("--by-name");
  return run_package(arguments);
}

void draw_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& folder) {
  const TemporaryFolder place;
  const std::string document = write_results(experiment, result, place.path());
  static_cast<void>(run_package({document, "--out", folder}, document));
}

std::string picture_of(const Experiment& experiment, const ExperimentResult& result, std::size_t level,
                       const std::string& ending, const PlotView& view) {
  const TemporaryFolder place;
  const std::string picture = (fs::path(place.path()) / ("picture" + ending)).string();
  const std::string document = write_results(experiment, result, place.path());
  std::vector<std::string> arguments = {document, "--figure", "world", "--file", picture};
  if (!result.runs.empty()) arguments.insert(arguments.end(), {"--level", std::to_string(level)});
  if (view.azimuth) arguments.insert(arguments.end(), {"--azimuth", fmt::format("{}", *view.azimuth)});
  if (view.elevation) arguments.insert(arguments.end(), {"--elevation", fmt::format("{}", *view.elevation)});
  static_cast<void>(run_package(arguments, document));
  return text_of(picture);
}

}  // namespace trellis::command
