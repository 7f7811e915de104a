// SPDX-License-Identifier: GPL-3.0-or-later
#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <trellis/base/process.hpp>
#include <trellis/reader/mesh_formats.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_output = std::size_t{256} << 20U;

/// Returns the path of the program that converts, "" if there is none: beside this program or library, or as installed.
std::string converter() {
  std::vector<fs::path> folders;
  std::error_code fault;
  if (const fs::path program = fs::read_symlink("/proc/self/exe", fault); !fault) {
    folders.push_back(program.parent_path());
  }
  // In Python the program is the interpreter, and this is in a library.
  if (Dl_info library{}; ::dladdr(reinterpret_cast<void*>(&converter), &library) != 0 && library.dli_fname != nullptr) {
    folders.push_back(fs::absolute(library.dli_fname, fault).parent_path());
  }
  for (const fs::path& folder : folders) {
    for (const char* place :
         {"trellis-mesh", "../trellis-mesh", "../../trellis-mesh", "../libexec/trellis/trellis-mesh"}) {
      if (const fs::path path = folder / place; ::access(path.c_str(), X_OK) == 0) return path.string();
    }
  }
  return "";
}

/// Returns an XML text without its comments.
std::string without_comments(std::string_view text) {
  constexpr std::string_view begin = "<!--", end = "-->";
  std::string kept;
  while (true) {
    const std::size_t from = text.find(begin);
    kept += text.substr(0, from);
    const std::size_t to = from == std::string_view::npos ? from : text.find(end, from + begin.size());
    if (to == std::string_view::npos) return kept;
    text.remove_prefix(to + end.size());
  }
}

/// Returns the value of an attribute of a tag, "" without.
std::string attribute(std::string_view tag, std::string_view name) {
  constexpr std::string_view blanks = " \t\r\n";
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    if (at == 0 || blanks.find(tag[at - 1]) == std::string_view::npos) continue;
    std::string_view rest = tag.substr(at + name.size());
    rest.remove_prefix(std::min(rest.size(), rest.find_first_not_of(blanks)));
    if (!rest.starts_with('=')) continue;
    rest.remove_prefix(1);
    rest.remove_prefix(std::min(rest.size(), rest.find_first_not_of(blanks)));
    if (!rest.starts_with('"') && !rest.starts_with('\'')) continue;
    const std::size_t end = rest.find(rest.front(), 1);
    return end == std::string_view::npos ? "" : std::string(rest.substr(1, end - 1));
  }
  return "";
}

}  // namespace

ColladaAsset collada_asset(std::string_view text) {
  ColladaAsset asset;
  const std::size_t begin = text.find("<asset");
  if (begin == std::string_view::npos) return asset;
  const std::string element = without_comments(text.substr(begin, text.find("</asset", begin) - begin));
  const std::string_view stated(element);
  if (const std::size_t axis = stated.find("<up_axis"); axis != std::string_view::npos) {
    const std::string_view value = stated.substr(axis, stated.find("</up_axis", axis) - axis);
    for (const auto& [name, up] : {std::pair{"X_UP", 'x'}, {"Y_UP", 'y'}, {"Z_UP", 'z'}}) {
      if (value.find(name) != std::string_view::npos) asset.up = up;
    }
  }
  if (const std::size_t unit = stated.find("<unit"); unit != std::string_view::npos) {
    const std::string_view tag = stated.substr(unit, stated.find('>', unit) - unit);
    const auto metres = number_in(attribute(tag, "meter"));
    if (metres && std::isfinite(*metres) && *metres > 0.0) asset.metres_in_unit = *metres;
    asset.unit_name = attribute(tag, "name");
  }
  return asset;
}

void read_dae(const MeshSource& source, Polygons& polygons) {
  if (source.unit != 1.0) throw source.error(0, "COLLADA states its unit; leave out unit");
  const std::string program = converter();
  if (program.empty()) {
    throw source.error(0,
                       "COLLADA is read by the program trellis-mesh, which is not installed: build Trellis where "
                       "libassimp-dev is, or convert the file to OBJ or STL");
  }
  if (source.text.empty()) throw source.error(0, "it is empty");
  Process convert{{program, "dae"}, {}, source.path, most_output};
  if (source.y_up) convert.words.emplace_back("y-up");
  ProcessEnd ended = run_process(convert);
  if (ended.fault != 0) {
    throw source.error(0, fmt::format("it cannot be converted: {}", std::generic_category().message(ended.fault)));
  }
  if (ended.too_long) throw source.error(0, "it is larger than a mesh may be");
  if (WIFSIGNALED(ended.status)) {
    const int signal = WTERMSIG(ended.status);
    throw source.error(0, signal == SIGXCPU || signal == SIGKILL ? "reading it takes too long or too much memory"
                                                                 : "it is damaged: reading it failed");
  }
  if (WEXITSTATUS(ended.status) != 0) {
    std::string_view line = std::string_view(ended.output).substr(0, ended.output.find('\n'));
    if (line.starts_with("error ")) line.remove_prefix(6);
    throw source.error(0, line.empty() ? std::string("it is damaged: reading it failed") : std::string(line));
  }
  const MeshSource converted{source.path, std::move(ended.output)};
  read_off(converted, polygons);
  polygons.format = "COLLADA";
}

}  // namespace trellis
