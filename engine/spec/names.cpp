#include "engine/spec/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <stdexcept>
#include <utility>

namespace troupe::engine {
namespace {

constexpr std::size_t k_most_digits = 9;             // any number with this many digits fits into 32 bits
constexpr std::uint32_t k_numbers_end = 1000000000;  // smallest number with more than k_most_digits digits

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Position at which the number at the end of `text` begins, or text.size() if there is no number. The number
/// is the longest one that has at most k_most_digits digits and no leading zeros. Each text is thus split
/// into a word and a number in exactly one way.
std::size_t number_begin(std::string_view text) {
  std::size_t begin = text.size();
  while (begin > 0 && text.size() - begin < k_most_digits && is_digit(text[begin - 1])) --begin;
  while (begin + 1 < text.size() && text[begin] == '0') ++begin;
  return begin;
}

std::uint32_t number_of(std::string_view digits) {
  std::uint32_t number = Name::k_no_number;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return number;
}

}  // namespace

Names::Names(std::vector<std::string> words) : words_(std::move(words)) {
  if (words_.empty() || !words_.front().empty())
    throw std::invalid_argument(
        fmt::format("Names(): {}: the first word must be \"\", because index 0 stands for no word",
                    words_.empty() ? "the list of words is empty"
                                   : fmt::format("the first word is \"{}\"", words_.front())));
  for (std::size_t i = 0; i < words_.size(); ++i)
    if (!positions_.emplace(words_[i], static_cast<std::uint32_t>(i)).second)
      throw std::invalid_argument(
          fmt::format("Names(): the word \"{}\" occurs twice: words must be unique", words_[i]));
}

std::uint32_t Names::intern(std::string_view word) {
  if (const auto found = positions_.find(word); found != positions_.end()) return found->second;
  const auto position = static_cast<std::uint32_t>(words_.size());
  words_.emplace_back(word);
  positions_.emplace(word, position);
  return position;
}

Name Names::add(std::string_view text) {
  const std::size_t begin = number_begin(text);
  return {intern(text.substr(0, begin)), number_of(text.substr(begin))};
}

Name Names::add(std::string_view text, std::uint32_t number) {
  const bool is_cut_here = (text.empty() || !is_digit(text.back())) && number < k_numbers_end;
  return is_cut_here ? Name{intern(text), number} : add(fmt::format("{}{}", text, number));
}

std::optional<Name> Names::find(std::string_view text) const {
  const std::size_t begin = number_begin(text);
  const auto word = positions_.find(text.substr(0, begin));
  if (word == positions_.end()) return {};
  return Name{word->second, number_of(text.substr(begin))};
}

std::string Names::text(Name name) const {
  const std::string& word = words_[name.word];
  return name.number == Name::k_no_number ? word : fmt::format("{}{}", word, name.number);
}

std::string_view without_number(std::string_view name) {
  while (!name.empty() && is_digit(name.back())) name.remove_suffix(1);
  return name;
}

bool is_of_population(std::string_view name, std::string_view population) {
  return name.size() > population.size() && name.starts_with(population) &&
         std::ranges::all_of(name.substr(population.size()), is_digit);
}

bool is_of_population(const Names& names, Name name, std::string_view population) {
  const std::string& word = names.words()[name.word];
  if (word == population) return name.number != Name::k_no_number;
  if (!word.starts_with(population) && !population.starts_with(word)) return false;
  return is_of_population(names.text(name), population);
}

std::string UniqueNames::add(std::string_view name) {
  constexpr int k_first = 2;
  const auto [taken, is_new] = next_.try_emplace(std::string(name), k_first);
  std::string unique(name);
  for (bool is_unique = is_new; !is_unique;) {
    unique = fmt::format("{}{}{}", name, mark_, taken->second++);
    is_unique = next_.try_emplace(unique, k_first).second;
  }
  return unique;
}

std::size_t NameMap::slot_of(Name name) const {
  // Consecutive numbers are in blocks of eight slots, 1.5 cache lines, because they are looked up together.
  constexpr std::uint32_t k_block = 8;
  const std::uint64_t block = (static_cast<std::uint64_t>(name.word) << 32 | name.number) / k_block;
  const std::uint64_t mixed = (block ^ block >> 29) * 0x9e3779b97f4a7c15u;  // 2^64 over the golden ratio
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = ((mixed >> 32) * k_block + name.number % k_block) & mask;
  while (slots_[i].body.valid() && slots_[i].name != name) i = (i + 1) & mask;
  return i;
}

void NameMap::reserve(std::size_t names) {
  constexpr std::size_t k_fewest = 16;
  const std::size_t wanted = std::bit_ceil(std::max(2 * names, k_fewest));
  if (wanted <= slots_.size()) return;
  std::vector<NamedBody> old(wanted);
  old.swap(slots_);
  for (const NamedBody& slot : old)
    if (slot.body.valid()) slots_[slot_of(slot.name)] = slot;
}

NamedBody& NameMap::take(Name name) {
  reserve(size_ + 1);
  NamedBody& slot = slots_[slot_of(name)];
  size_ += !slot.body.valid();
  slot.name = name;
  return slot;
}

BodyId NameMap::add(Name name, BodyId body) {
  NamedBody& slot = take(name);
  if (!slot.body.valid()) slot.body = body;
  return slot.body;
}

void NameMap::set(Name name, BodyId body) { take(name).body = body; }

BodyId NameMap::find(Name name) const { return size_ > 0 ? slots_[slot_of(name)].body : BodyId(); }

}  // namespace troupe::engine
