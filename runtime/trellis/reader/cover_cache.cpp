// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/cover_cache.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/input_file.hpp>
#include <trellis/base/random.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view magic = "trellis cover 1\n";
constexpr std::string_view ending = ".cover";

/// Appends eight bytes, the lowest first, on every machine.
void put(std::string& bytes, std::uint64_t value) {
  for (unsigned i = 0; i < 8; ++i) bytes += static_cast<char>(value >> (8U * i) & 0xffU);
}
void put(std::string& bytes, double value) { put(bytes, std::bit_cast<std::uint64_t>(value)); }
void put(std::string& bytes, const Vec3& v) {
  for (const double x : {v.x, v.y, v.z}) put(bytes, x);
}

std::uint64_t integer_at(std::string_view bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) value |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8U * i);
  return value;
}
double number_at(std::string_view bytes, std::size_t at) { return std::bit_cast<double>(integer_at(bytes, at)); }

struct PutShape {
  std::string& bytes;

  void operator()(const Sphere& s) const { put(bytes, s.radius); }
  void operator()(const Cuboid& s) const { put(bytes, s.size); }
  void operator()(const Cylinder& s) const {
    put(bytes, s.radius);
    put(bytes, s.length);
  }
  void operator()(const Capsule& s) const {
    put(bytes, s.radius);
    put(bytes, s.length);
  }
  void operator()(const std::shared_ptr<const Mesh>& mesh) const {
    put(bytes, std::uint64_t{mesh->vertices().size()});
    for (const Vec3& v : mesh->vertices()) put(bytes, v);
    for (const auto& [a, b, c] : mesh->triangles()) {
      put(bytes, std::uint64_t{a} << 32U | b);
      put(bytes, std::uint64_t{c});
    }
  }
  void operator()(const std::shared_ptr<const PointCloud>&) const {}  // which no link has
};

/// Returns 32 digits: two hashes of all that a cover depends on.
std::string key_of(std::span<const Solid> solids, const CoverOptions& options) {
  std::string bytes;
  put(bytes, std::uint64_t{medial_cover_version});
  put(bytes, options.excess);
  put(bytes, options.most_excess);
  put(bytes, std::uint64_t{options.most_balls});
  put(bytes, options.work);
  for (const Solid& solid : solids) {
    put(bytes, std::uint64_t{solid.shape.index()});
    put(bytes, solid.pose.position);
    const Quaternion& turn = solid.pose.orientation;
    for (const double x : {turn.x, turn.y, turn.z, turn.w}) put(bytes, x);
    std::visit(PutShape{bytes}, solid.shape);
  }
  const std::uint64_t first = stable_hash(bytes);
  put(bytes, first);
  std::reverse(bytes.begin(), bytes.end());
  return fmt::format("{:016x}{:016x}", first, stable_hash(bytes));
}

std::string text_of(const MedialCover& cover, const std::string& key) {
  std::string bytes(magic);
  bytes += key;
  put(bytes, cover.excess);
  put(bytes, std::uint64_t{cover.balls.size()});
  for (const BodySphere& ball : cover.balls) {
    put(bytes, ball.centre);
    put(bytes, ball.radius);
  }
  put(bytes, stable_hash(bytes));
  return bytes;
}

/// Returns the cover in the bytes of a file; none where they are no such file.
std::optional<MedialCover> cover_in(std::string_view bytes, const std::string& key) {
  const std::size_t head = magic.size() + key.size();
  if (bytes.size() < head + 24 || !bytes.starts_with(magic) || bytes.substr(magic.size(), key.size()) != key) return {};
  const std::size_t end = bytes.size() - 8;
  if (integer_at(bytes, end) != stable_hash(bytes.substr(0, end))) return {};
  MedialCover cover;
  cover.excess = number_at(bytes, head);
  const std::size_t count = (end - head - 16) / 32;
  if (integer_at(bytes, head + 8) != count || end != head + 16 + 32 * count) return {};
  bool sound = std::isfinite(cover.excess) && cover.excess >= 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = head + 16 + 32 * i;
    const BodySphere ball{{number_at(bytes, at), number_at(bytes, at + 8), number_at(bytes, at + 16)},
                          number_at(bytes, at + 24)};
    sound = sound && std::isfinite(norm(ball.centre)) && std::isfinite(ball.radius) && ball.radius >= 0.0;
    cover.balls.push_back(ball);
  }
  if (!sound) return {};
  return cover;
}

std::optional<std::string> bytes_of(const fs::path& path) {
  constexpr std::uintmax_t most = 64U << 20U;
  InputFile file(path.string(), most);
  if (!file.fault().empty()) return {};
  std::string bytes = file.rest();
  if (!file.fault().empty()) return {};
  return bytes;
}

void write(const fs::path& path, const std::string& bytes) {
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  std::string name = path.string() + ".XXXXXX";
  const int file = mkstemp(name.data());
  if (file < 0) return;
  const bool written = ::write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  const bool closed = close(file) == 0;
  std::error_code failed;
  if (written && closed) fs::rename(name, path, failed);
  if (!written || !closed || failed) fs::remove(name, ignored);
}

/// Whether balls have to be searched for.
bool takes_time(const Solid& solid) {
  return !std::holds_alternative<Sphere>(solid.shape) && !std::holds_alternative<Capsule>(solid.shape);
}

}  // namespace

MedialCover CoverCache::cover(std::span<const Solid> solids, const CoverOptions& options) const {
  if (!folder_ || std::none_of(solids.begin(), solids.end(), takes_time)) return medial_cover(solids, options);
  const std::string key = key_of(solids, options);
  const fs::path path = *folder_ / (key + std::string(ending));
  if (const auto bytes = bytes_of(path)) {
    if (auto known = cover_in(*bytes, key)) return *std::move(known);
  }
  MedialCover made = medial_cover(solids, options);
  write(path, text_of(made, key));
  return made;
}

LinkCovers CoverCache::covers(const KinematicTree& tree, const CoverOptions& options) const {
  LinkCovers all{options, {}};
  std::map<std::string, std::size_t> known;
  for (const Link& link : tree.links()) {
    const auto [at, added] = known.emplace(key_of(link.solids, options), all.links.size());
    all.links.push_back(added ? cover(link.solids, options) : MedialCover(all.links[at->second]));
  }
  return all;
}

void CoverCache::trim(std::uintmax_t most) const {
  if (!folder_) return;
  std::vector<std::tuple<fs::file_time_type, std::string, std::uintmax_t>> files;
  std::uintmax_t sum = 0;
  std::error_code failed;
  for (fs::directory_iterator at(*folder_, failed), end; !failed && at != end; at.increment(failed)) {
    std::error_code ignored;
    const std::uintmax_t size = at->file_size(ignored);
    if (ignored) continue;
    const auto time = at->last_write_time(ignored);
    if (ignored) continue;
    files.emplace_back(time, at->path().string(), size);
    sum += size;
  }
  std::sort(files.begin(), files.end());
  for (const auto& [time, path, size] : files) {
    if (sum <= most) break;
    std::error_code ignored;
    fs::remove(path, ignored);
    sum -= size;
  }
}

std::optional<std::filesystem::path> user_cover_folder() {
  const auto variable = [](const char* name) -> std::string {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing here sets it
    return value != nullptr ? value : "";
  };
  if (const std::string off = variable("TRELLIS_NO_CACHE"); !off.empty() && off != "0") return {};
  // The specification of XDG: a path that is not absolute counts as none.
  if (const fs::path cache = variable("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "trellis" / "covers";
  if (const fs::path home = variable("HOME"); home.is_absolute()) return home / ".cache" / "trellis" / "covers";
  return {};
}

}  // namespace trellis
