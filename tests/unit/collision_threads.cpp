// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <thread>

#include "collision_worlds.hpp"
#include "support/catch.hpp"

// A checker's use of the process: no memory allocation while it checks, and no shared mutable state.

using namespace collision_test;

// The address sanitizer has its own allocator, which conflicts with this one.
#if !defined(__SANITIZE_ADDRESS__)

namespace {

thread_local std::size_t allocations = 0;

void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, rounded == 0 ? alignment : rounded);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

TEST_CASE("checking allocates nothing once it is warm") {
  auto cases = paper_cases();
  for (auto& c : mixed_cases()) cases.push_back(std::move(c));
  for (const Case& c : cases) {
    INFO(c.name);
    const auto checker = make_planar_checker(c.scene, c.space, 0.05);
    Configuration a(c.space.dimension());
    Configuration b(c.space.dimension());
    std::size_t before = 0;
    for (const bool warm : {false, true}) {
      Stream stream(8, c.name, "allocation");
      before = allocations;
      for (int i = 0; i < 5000; ++i) {
        c.space.sample_uniform(stream, a);
        // Motions of all lengths, without the allocations of random_motion.
        c.space.sample_uniform(stream, b);
        for (std::size_t j = 0; j < b.size(); ++j) b[j] = a[j] + 0.2 * (b[j] - a[j]);
        static_cast<void>(checker->motion(a, b));
        static_cast<void>(checker->valid(a));
      }
      if (warm) CHECK(allocations == before);
    }
  }
}

#endif

TEST_CASE("checkers of one scene in several threads say what one alone says", "[slow]") {
  constexpr int motions = 5000;
  constexpr std::size_t threads = 4;
  for (const Case& c : mixed_cases()) {
    for (const std::string backend : {"planar", "fcl"}) {
      INFO(c.name + ", " << backend);
      const auto run = [&] {
        const auto checker = make_checker(backend, c.scene, c.space, 0.05);
        Stream stream(9, c.name, "threads");
        Configuration a(c.space.dimension());
        Configuration b(c.space.dimension());
        std::vector<MotionReport> reports;
        for (int i = 0; i < motions; ++i) {
          random_motion(stream, c.space, a, b);
          reports.push_back(checker->motion(a, b));
        }
        return reports;
      };
      const auto expected = run();
      std::atomic<int> differences = 0;
      std::vector<std::thread> workers;
      for (std::size_t i = 0; i < threads; ++i) {
        workers.emplace_back([&] {
          const auto reports = run();
          for (std::size_t k = 0; k < reports.size(); ++k) differences += same(reports[k], expected[k]) ? 0 : 1;
        });
      }
      for (auto& worker : workers) worker.join();
      CHECK(differences == 0);
    }
  }
}
