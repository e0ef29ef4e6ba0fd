#include "worldio/json/json_text.hpp"

#include "base/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace troupe::worldio {
namespace {

constexpr std::size_t k_width = 110;  // maximum length of a line, bytes
constexpr std::size_t k_step = 2;     // indentation per level

std::string text_of(const std::string& text) {
  std::string out = "\"";
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t bytes = utf8_length(rest);
    if (bytes == 0)
      throw std::runtime_error(
          fmt::format("a name or text in the world is not UTF-8, which JSON requires; the text begins with "
                      "\"{}\": write this text in UTF-8",
                      text.substr(0, text.size() - rest.size())));
    const char c = rest.front();
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (bytes == 1 && static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += rest.substr(0, bytes);
    rest.remove_prefix(bytes);
  }
  return out + '"';
}

std::string json_number(double x) {
  if (!std::isfinite(x))
    throw std::runtime_error(
        fmt::format("a number in the world is {}, which JSON cannot represent: give a finite number", x));
  if (x == 0) return std::signbit(x) ? "-0.0" : "0";  // "-0" would be read back as the integer 0
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), x);
  return {digits.data(), end};
}

class Printer {
 public:
  static std::string line(const JsonNode& node) {
    std::string out;
    compact(node, std::numeric_limits<std::size_t>::max(), out);
    return out;
  }

  std::string print(const JsonNode& document) {
    add(document, 0);
    return std::move(out_) + '\n';
  }

 private:
  /// Appends a value on one line to `out`. If `out` gets longer than `most` bytes, stops and returns false.
  static bool compact(const JsonNode& node, std::size_t most, std::string& out) {
    if (const JsonNode::List* list = node.list()) {
      out += '[';
      for (const JsonNode& item : *list) {
        if (&item != &list->front()) out += ", ";
        if (!compact(item, most, out)) return false;
      }
      out += ']';
    } else if (const JsonNode::Object* object = node.object()) {
      out += '{';
      for (const JsonMember& member : *object) {
        if (&member != &object->front()) out += ", ";
        out += text_of(member.key) + ": ";
        if (!compact(member.node, most, out)) return false;
      }
      out += '}';
    } else {
      out += scalar(node);
    }
    return out.size() <= most;
  }

  static std::string scalar(const JsonNode& node) {
    if (const bool* x = std::get_if<bool>(&node.value)) return *x ? "true" : "false";
    if (const auto* x = std::get_if<std::int64_t>(&node.value)) return std::to_string(*x);
    if (const auto* x = std::get_if<std::uint64_t>(&node.value)) return std::to_string(*x);
    if (const auto* x = std::get_if<double>(&node.value)) return json_number(*x);
    if (const std::string* x = node.text()) return text_of(*x);
    return "null";
  }

  void add(const JsonNode& node, std::size_t indent) {
    const std::size_t used = out_.size() - (out_.rfind('\n') + 1);  // npos + 1 is 0
    std::string line;
    const bool fits = compact(node, k_width > used ? k_width - used : 0, line);
    const JsonNode::List* list = node.list();
    const JsonNode::Object* object = node.object();
    const bool has_parts = (list && !list->empty()) || (object && !object->empty());
    if (fits || !has_parts) {
      out_ += line;
    } else if (list) {
      add_list(*list, indent + k_step);
      end_line(indent);
      out_ += ']';
    } else {
      out_ += '{';
      for (const JsonMember& member : *object) {
        if (&member != &object->front()) out_ += ',';
        end_line(indent + k_step);
        out_ += text_of(member.key) + ": ";
        add(member.node, indent + k_step);
      }
      end_line(indent);
      out_ += '}';
    }
  }

  /// Appends a list on several lines. If all entries are scalars or lists of scalars, each line has as many
  /// entries as fit; otherwise each entry gets a line of its own.
  void add_list(const JsonNode::List& list, std::size_t indent) {
    const auto is_short = [](const JsonNode& node) {
      const JsonNode::List* numbers = node.list();
      return numbers
                 ? std::ranges::all_of(*numbers, [](const JsonNode& x) { return !x.list() && !x.object(); })
                 : !node.object();
    };
    const bool fills = std::ranges::all_of(list, is_short);
    out_ += '[';
    for (const JsonNode& item : list) {
      const bool is_first = &item == &list.front();
      if (!is_first) out_ += ',';
      std::string next;
      const std::size_t used = out_.size() - (out_.rfind('\n') + 1);
      if (fills && !is_first && used < k_width && compact(item, k_width - used, next))
        out_ += ' ';
      else
        end_line(indent);
      add(item, indent);
    }
  }

  void end_line(std::size_t indent) {
    out_ += '\n';
    out_.append(indent, ' ');
  }

  std::string out_;
};

}  // namespace

JsonNode json_numbers(std::span<const double> numbers) {
  JsonNode::List list;
  for (const double x : numbers) list.push_back(json_node(x));
  return json_node(std::move(list));
}

std::string json_line(const JsonNode& node) { return Printer::line(node); }

std::string json_text(const JsonNode& document) { return Printer().print(document); }

}  // namespace troupe::worldio
