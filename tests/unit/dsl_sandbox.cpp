// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "support/catch.hpp"
#include "support/script.hpp"

#include <dsl/lua/state.hpp>

namespace fs = std::filesystem;
using namespace trellis;
using test::failure;
using test::value;
using test::values;

namespace {

/// A folder that goes with the object.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("trellis-dsl-" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name) << text;
    return (path_ / name).string();
  }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

}  // namespace

TEST_CASE("scripts reach no files, processes, bytecode or internals") {
  for (const std::string name : {"io", "os", "debug", "package", "dofile", "loadfile"}) {
    INFO(name);
    CHECK(failure("return " + name).find("there is no '" + name + "' here") != std::string::npos);
  }
  CHECK(value("string.dump") == "nil");
  CHECK(failure("return load('\\27Lua', 'x', 'b')").find("bytecode") != std::string::npos);
  CHECK(value("(load('\\27Lua'))") == "nil");
  CHECK(value("load('return 1 + 1')()") == "2");
  CHECK(value("load('return x', 'chunk', 't', { x = 5 })()") == "5");
  CHECK(value("getmetatable(rrt {})") == "planner");
  CHECK(value("getmetatable(_G)") == "false");
  CHECK(failure("setmetatable(_G, nil)").find("protected") != std::string::npos);
}

TEST_CASE("the rest of Lua is there") {
  CHECK(value("table.concat({1, 2, 3}, ',')") == "1,2,3");
  CHECK(value("('abc'):upper()") == "ABC");
  CHECK(value("utf8.len('ä')") == "1");
  CHECK(value("math.max(1, 2)") == "2");
  CHECK(value("select('#', pcall(error))") == "2");
  CHECK(value("coroutine.wrap(function() coroutine.yield(7) end)()") == "7");
}

TEST_CASE("an unknown global is an error with the nearest name, a new one can be set") {
  CHECK(failure("return rtr").find("unknown name 'rtr' (did you mean 'rrt'?)") != std::string::npos);
  CHECK(failure("return scene").find("did you mean 'scenes'?") != std::string::npos);
  CHECK(values("answer = 42 return answer, rawget(_G, 'nothing')") == std::vector<std::string>{"42", "nil"});
}

TEST_CASE("math.random follows the seed and keeps Lua's meaning") {
  const std::string draw = "math.random(), math.random(6), math.random(-3, 3), math.random(0)";
  CHECK(values("return " + draw) == values("return " + draw));
  CHECK(values("return " + draw, {.seed = 1}) == values("return " + draw));
  CHECK(values("return " + draw, {.seed = 2}) != values("return " + draw));
  CHECK(values("math.randomseed(2) return " + draw) == values("return " + draw, {.seed = 2}));
  CHECK(values("math.random() math.randomseed() return " + draw) == values("return " + draw));
  CHECK(values("math.randomseed(3.0) return " + draw) == values("math.randomseed(3) return " + draw));
  CHECK(value("(function() for _ = 1, 1000 do local x, k, m = math.random(), math.random(6), math.random(-3, 3) "
              "if x < 0 or x >= 1 or k < 1 or k > 6 or m < -3 or m > 3 or math.type(k) ~= 'integer' then return 'out' "
              "end end return 'in' end)()") == "in");
  CHECK(value("math.type(math.random(math.mininteger, math.maxinteger))") == "integer");
  CHECK(value("math.random(5, 5)") == "5");
  CHECK(failure("math.random(2, 1)").find("the interval from 2 to 1 is empty") != std::string::npos);
  CHECK(failure("math.random(1.5)").find("must be an integer, got 1.5") != std::string::npos);
  CHECK(failure("math.random(1, 2, 3)").find("at most 2 arguments") != std::string::npos);
}

TEST_CASE("memory has a limit, and the interpreter lives on") {
  dsl::Session session("", {.memory = std::size_t{16} << 20U});
  const auto greedy = [&] { session.evaluate("local t = {} for i = 1, 1e9 do t[i] = {i} end", "test.lua"); };
  CHECK_THROWS_WITH(greedy(), "the script needs more memory than the 16 MiB it may use");
  CHECK(session.evaluate("return 1", "test.lua").front() == "1");
}

TEST_CASE("recursion without end is an error") {
  CHECK(failure("local function f() return 1 + f() end f()").find("stack overflow") != std::string::npos);
  CHECK(failure("local t = {} t.__index = function(_, k) return t[k] end setmetatable(t, t) return t.x")
            .find("overflow") != std::string::npos);
  CHECK(failure("local t = {} for i = 1, 1e5 do t = {t} end "
                "return experiment { problems = t, strategies = { a = rrt {} } }")
            .find("nested over") != std::string::npos);
}

TEST_CASE("what a script throws comes with a traceback, what we say does not") {
  CHECK(failure("error('no luck')").find("test.lua:1: no luck\nstack traceback:") == 0);
  CHECK(failure("rrt { step = -1 }").find("traceback") == std::string::npos);
  CHECK(failure("error(setmetatable({}, { __tostring = function() return 'odd' end }))").starts_with("odd\nstack"));
}

TEST_CASE("modules come from the standard library and the script's folder, each once") {
  const Folder folder;
  folder.write("mine.lua", "loads = (rawget(_G, 'loads') or 0) + 1\nreturn { name = ..., step = 0.5 }");
  folder.write("deep/er.lua", "return 'deeper'");
  folder.write("a.lua", "return require 'b'");
  folder.write("b.lua", "return require 'a'");
  folder.write("wrong.lua", "\nreturn shrink(7)");
  folder.write("broken.lua", "\n\nlocal = 3");
  folder.write("silent.lua", "");
  dsl::Session session(folder.path());
  const auto evaluate = [&](const std::string& text) { return session.evaluate(text, "test.lua").front(); };
  CHECK(evaluate("return require('mine').step + require('mine').step") == "1.0");
  CHECK(evaluate("return require('mine').name") == "mine");
  CHECK(evaluate("return loads") == "1");
  CHECK(evaluate("return require 'deep.er'") == "deeper");
  CHECK(evaluate("return require 'silent'") == "true");
  CHECK(evaluate("return require 'scenes' == scenes") == "true");
  CHECK(evaluate("return tostring(strategies.nested())") ==
        evaluate("return tostring(skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 })"));
  CHECK_THROWS_WITH(evaluate("require 'a'"), Catch::Contains("in a cycle: a -> b -> a"));
  CHECK_THROWS_WITH(evaluate("require 'wrong'"), Catch::Contains("wrong.lua:2: shrink: option 'scale'"));
  CHECK_THROWS_WITH(evaluate("require 'broken'"), Catch::Contains("broken.lua:3: "));
  CHECK_THROWS_WITH(evaluate("require 'mien'"), Catch::Contains("no module 'mien'"));
  CHECK_THROWS_WITH(evaluate("require '..secrets'"), Catch::Contains("no module name"));
}

TEST_CASE("a fault of ours is not hidden by a script that catches everything") {
  lua::State state(std::size_t{16} << 20U);
  const auto run = [&] {
    state.run([](lua::Stack& stack) {
      lua::open_libraries(stack);
      stack.push_function([](lua::Stack&) -> int { throw std::logic_error("broken"); });
      stack.set_global("break_it");
      stack.load("pcall(break_it) return 1", "@test.lua");
      stack.call(0);
    });
  };
  CHECK_THROWS_AS(run(), std::logic_error);
}

TEST_CASE("C++ objects are destroyed when a Lua error passes them") {
  struct Witness {
    int* count;
    explicit Witness(int* c) : count(c) {}
    ~Witness() { ++*count; }
  };
  int destroyed = 0;
  lua::State state(std::size_t{16} << 20U);
  state.run([&](lua::Stack& stack) {
    lua::open_libraries(stack);
    stack.push_function([&](lua::Stack& call) {
      const Witness witness(&destroyed);
      call.load("error('out')", "@inner.lua");
      call.call(0);
      return 0;
    });
    stack.set_global("call_out");
    stack.load("return pcall(call_out)", "@test.lua");
    stack.call(0);
  });
  CHECK(destroyed == 1);
}
