// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/globals.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <lua.hpp>
#include <utility>

namespace trellis::lua {

namespace {

// Only the compiled code shows which names are global. lua_dump writes it as bytes whose format depends on the version:
// this source reads that of 5.4.
static_assert(LUA_VERSION_NUM == 504);

struct Function {
  int line = 0;
  std::vector<std::uint32_t> code;
  std::vector<std::string> constants;      ///< "" for a constant that is no string
  std::vector<signed char> steps;          ///< line increments, from instruction to instruction
  std::vector<std::pair<int, int>> lines;  ///< instructions with an absolute line
  std::vector<std::string> upvalues;
};

class Reader {
 public:
  Reader(std::string_view bytes, std::vector<GlobalUse>& uses) : bytes_(bytes), uses_(uses) {}

  void read() {
    // Signature, version, format, LUAC_DATA, three sizes, an integer and a number for comparison.
    constexpr std::size_t header = 4 + 1 + 1 + 6 + 3 + sizeof(lua_Integer) + sizeof(lua_Number);
    skip(header);
    skip(1);  // the number of the main chunk's upvalues
    function();
  }

 private:
  void function() {
    Function f;
    string();  // the source
    f.line = integer();
    integer();  // the last line
    skip(3);    // parameters, whether variadic, registers
    f.code.resize(count());
    for (auto& instruction : f.code) instruction = plain<std::uint32_t>();
    f.constants.resize(count());
    for (auto& constant : f.constants) constant = read_constant();
    skip(3 * count());  // descriptions of upvalues
    // The inner functions precede the names of this function's code; their uses follow its own.
    std::vector<GlobalUse> inner;
    {
      std::vector<GlobalUse> outer = std::move(uses_);
      uses_.clear();
      for (std::size_t n = count(); n > 0; --n) function();
      inner = std::exchange(uses_, std::move(outer));
    }
    f.steps.resize(count());
    for (auto& step : f.steps) step = plain<signed char>();
    f.lines.resize(count());
    for (auto& [instruction, line] : f.lines) {
      instruction = integer();
      line = integer();
    }
    for (std::size_t n = count(); n > 0; --n) {  // local variables
      string();
      integer();
      integer();
    }
    f.upvalues.resize(count());
    for (auto& name : f.upvalues) name = string();
    look(f);
    uses_.insert(uses_.end(), inner.begin(), inner.end());
  }

  void look(const Function& f) {
    constexpr std::uint32_t get = 11,
                            set = 15;  // OP_GETTABUP A B C: A = Up[B][K[C]]; OP_SETTABUP A B C: Up[A][K[B]] = C
    int line = f.line;
    std::size_t next_line = 0;
    for (std::size_t i = 0; i < f.code.size(); ++i) {
      constexpr signed char outright = -0x80;
      if (i < f.steps.size()) {
        if (f.steps[i] == outright && next_line < f.lines.size()) {
          line = f.lines[next_line++].second;
        } else {
          line += f.steps[i];
        }
      }
      const std::uint32_t instruction = f.code[i];
      const std::uint32_t operation = instruction & 0x7FU;
      const std::uint32_t a = instruction >> 7U & 0xFFU, b = instruction >> 16U & 0xFFU, c = instruction >> 24U;
      if (operation != get && operation != set) continue;
      const std::uint32_t table = operation == get ? b : a, key = operation == get ? c : b;
      if (table >= f.upvalues.size() || f.upvalues[table] != "_ENV" || key >= f.constants.size()) continue;
      uses_.push_back({f.constants[key], line, operation == set});
    }
  }

  std::string read_constant() {
    constexpr std::uint8_t short_string = 0x04, long_string = 0x14, whole = 0x03, real = 0x13;
    switch (plain<std::uint8_t>()) {
      case short_string:
      case long_string: return string();
      case whole: skip(sizeof(lua_Integer)); break;
      case real: skip(sizeof(lua_Number)); break;
      default: break;  // nil, false, true
    }
    return "";
  }

  /// Seven bits a byte, the highest first; the last byte is marked.
  std::size_t count() {
    constexpr unsigned bits = 7;
    std::size_t value = 0;
    while (true) {
      const auto byte = plain<std::uint8_t>();
      value = value << bits | (byte & 0x7FU);
      if ((byte & 0x80U) != 0) return value;
    }
  }
  int integer() { return static_cast<int>(count()); }
  std::string string() {
    const std::size_t size = count();
    if (size <= 1) return "";
    need(size - 1);
    std::string text(bytes_.substr(0, size - 1));
    skip(size - 1);
    return text;
  }
  template <class T>
  T plain() {
    need(sizeof(T));
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    skip(sizeof(T));
    return value;
  }
  void skip(std::size_t size) {
    need(size);
    bytes_.remove_prefix(size);
  }
  void need(std::size_t size) const {
    if (size > bytes_.size()) throw Fault("Lua's compiled form is not what it should be");
  }

  std::string_view bytes_;
  std::vector<GlobalUse>& uses_;
};

int append(lua_State*, const void* block, std::size_t size, void* bytes) {
  static_cast<std::string*>(bytes)->append(static_cast<const char*>(block), size);
  return 0;
}

}  // namespace

std::vector<GlobalUse> global_uses(Stack& stack, std::string_view text, const std::string& chunk) {
  stack.load(text, chunk);
  std::string bytes;
  lua_dump(stack.state(), append, &bytes, 0);
  stack.resize(stack.size() - 1);
  std::vector<GlobalUse> uses;
  Reader(bytes, uses).read();
  return uses;
}

}  // namespace trellis::lua
