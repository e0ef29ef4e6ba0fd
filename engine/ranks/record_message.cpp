#include "engine/ranks/record_message.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

void put_value(MessageWriter& message, const Value& value) {
  message.put(static_cast<std::uint8_t>(value.v.index()));
  const auto put_all = [&](const auto& list, auto&& put_one) {
    message.put(static_cast<std::uint64_t>(list.size()));
    for (const auto& each : list) put_one(each);
  };
  const auto put_text = [&](const std::string& text) { message.put_text(text); };
  if (const auto* x = std::get_if<bool>(&value.v)) message.put(*x);
  if (const auto* x = std::get_if<std::int64_t>(&value.v)) message.put(*x);
  if (const auto* x = std::get_if<double>(&value.v)) message.put(*x);
  if (const auto* x = std::get_if<std::string>(&value.v)) put_text(*x);
  if (const auto* x = std::get_if<std::vector<double>>(&value.v))
    put_all(*x, [&](double number) { message.put(number); });
  if (const auto* x = std::get_if<std::vector<Record>>(&value.v))
    put_all(*x, [&](const Record& record) { put_record(message, record); });
  if (const auto* x = std::get_if<std::vector<std::string>>(&value.v)) put_all(*x, put_text);
}

Value get_value(MessageReader& message) {
  const auto get_all = [&](auto list, auto&& get_one) {
    for (std::size_t left = message.get_count(1); left > 0; --left) list.push_back(get_one());
    return Value(std::move(list));
  };
  switch (message.get<std::uint8_t>()) {  // Value::v.index() of the value that put_value() has appended
    case 1: return {message.get<bool>()};
    case 2: return {message.get<std::int64_t>()};
    case 3: return {message.get<double>()};
    case 4: return {message.get_text()};
    case 5: return get_all(std::vector<double>(), [&] { return message.get<double>(); });
    case 6: return get_all(std::vector<Record>(), [&] { return get_record(message); });
    case 7: return get_all(std::vector<std::string>(), [&] { return message.get_text(); });
    default: return {};
  }
}

}  // namespace

void put_record(MessageWriter& message, const Record& record) {
  message.put(static_cast<std::uint64_t>(record.size()));
  for (const Value& value : record) put_value(message, value);
}

Record get_record(MessageReader& message) {
  Record record(message.get_count(1));  // each value has at least the byte of its type
  for (Value& value : record) value = get_value(message);
  return record;
}

}  // namespace troupe::engine
