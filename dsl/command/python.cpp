// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/python.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <trellis/base/error.hpp>
#include <trellis/base/process.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

/// Returns the folder of the Python package, "" without: beside this program, or as installed.
std::string package() {
  std::error_code fault;
  const fs::path program = fs::read_symlink("/proc/self/exe", fault);
  if (fault) return "";
  for (const char* place : {"python", "../python", "../share/trellis/python"}) {
    const fs::path folder = program.parent_path() / place;
    if (fs::exists(folder / "trellis" / "columns.py", fault)) return folder.lexically_normal().string();
  }
  return "";
}

/// Returns the environment of this process with a folder of Python's modules before those that the user has.
std::vector<std::string> environment_with(const std::string& modules) {
  std::vector<std::string> variables;
  const std::string key = "PYTHONPATH=";
  std::string paths = key + modules;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string one = *variable;
    if (!one.starts_with(key)) {
      variables.push_back(one);
    } else if (one.size() > key.size()) {
      paths += (modules.empty() ? "" : ":") + one.substr(key.size());
    }
  }
  if (paths.size() > key.size()) variables.push_back(paths);
  return variables;
}

/// Returns a Python that has these modules, "" without: TRELLIS_PYTHON if it is set, else the first python3.
std::string interpreter(const std::vector<const char*>& needed) {
  std::vector<std::string> candidates = {"python3", "/usr/bin/python3"};
  if (const char* given = std::getenv("TRELLIS_PYTHON"); given != nullptr && *given != '\0') candidates = {given};
  const std::string question =
      fmt::format("import importlib.util as u, sys\nsys.exit(any(u.find_spec(name) is None for name in '{}'.split()))",
                  fmt::join(needed, " "));
  for (const std::string& candidate : candidates) {
    if (run_process({{candidate, "-c", question}, environment_with("")}).succeeded()) return candidate;
  }
  return "";
}

}  // namespace

std::string run_python(const PythonModule& module, const std::vector<std::string>& arguments, const std::string& own) {
  const std::string modules = package();
  if (modules.empty()) {
    throw Error(
        fmt::format("{}: the Python package 'trellis' is not beside this program: build or install all of Trellis",
                    module.subject));
  }
  const std::string python = interpreter(module.needed);
  if (python.empty()) {
    throw Error(fmt::format("{}, or set TRELLIS_PYTHON to a Python that has them", module.missing));
  }
  Process process{{python, "-m", module.name}, environment_with(modules)};
  process.words.insert(process.words.end(), arguments.begin(), arguments.end());
  const ProcessEnd ended = run_process(process);
  if (ended.succeeded()) return ended.output;
  // Of a fault of Python the last line says what it was.
  std::string text = ended.errors;
  while (text.ends_with('\n')) text.pop_back();
  if (ended.exit_status() != 1 || text.starts_with("Traceback")) text = text.substr(text.rfind('\n') + 1);
  if (!own.empty() && text.starts_with(own)) text.replace(0, own.size(), module.subject);
  throw Error(text.empty() ? fmt::format("{}: Python was ended before it was done", module.subject) : text);
}

}  // namespace trellis::command
