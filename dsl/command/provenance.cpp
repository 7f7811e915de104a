// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/provenance.hpp>

#include <fmt/format.h>
#include <sys/utsname.h>

#include <fstream>
#include <string>
#include <thread>

#include <trellis/base/version.hpp>

namespace trellis::command {

namespace {

/// Returns the first processor's name; "" where Linux does not name it.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "";
}

std::string system() {
  struct utsname name {};
  return ::uname(&name) == 0 ? fmt::format("{} {} {}", name.sysname, name.release, name.machine) : "";
}

}  // namespace

std::string version_and_commit() { return commit().empty() ? version() : fmt::format("{} ({})", version(), commit()); }

std::map<std::string, std::string> machine() {
#ifdef __clang__
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "gcc " __VERSION__;
#endif
  return {{"system", system()},
          {"processor", processor()},
          {"cores", std::to_string(std::thread::hardware_concurrency())},
          {"compiler", compiler}};
}

}  // namespace trellis::command
