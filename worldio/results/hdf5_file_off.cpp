#include "worldio/results/hdf5_file.hpp"

// Replaces hdf5_file.cpp in a build without HDF5: files can neither be created nor opened, so the other
// functions are never called.

namespace troupe::worldio {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw Hdf5Error(file.string() +
                  ": error: this build of Troupe has no HDF5: configure it with TROUPE_HDF5=ON");
}

}  // namespace

bool has_hdf5() { return false; }

void require_hdf5(const std::filesystem::path& file) { refuse(file); }

Hdf5Id::Hdf5Id(Hdf5Id&&) noexcept = default;
Hdf5Id& Hdf5Id::operator=(Hdf5Id&&) noexcept = default;
bool Hdf5Id::reset() noexcept { return true; }

void Hdf5Object::set_text(const std::string&, std::string_view) { refuse(file_); }
void Hdf5Object::set_integer(const std::string&, std::int64_t) { refuse(file_); }
void Hdf5Object::set_number(const std::string&, double) { refuse(file_); }
std::vector<std::string> Hdf5Object::attributes() const { refuse(file_); }
bool Hdf5Object::has_attribute(const std::string&) const { refuse(file_); }
std::string Hdf5Object::text(const std::string&) const { refuse(file_); }
std::int64_t Hdf5Object::integer(const std::string&) const { refuse(file_); }
double Hdf5Object::number(const std::string&) const { refuse(file_); }
void Hdf5Object::copy_attributes(const Hdf5Object&) { refuse(file_); }
std::uint64_t Hdf5Object::bytes_in_file() const { refuse(file_); }
void Hdf5Object::fail(std::string_view) const { refuse(file_); }

std::size_t Hdf5Dataset::row_values() const { refuse(file_); }
std::size_t Hdf5Dataset::values() const { refuse(file_); }
void Hdf5Dataset::write_bytes(std::span<const std::byte>) { refuse(file_); }
void Hdf5Dataset::read_bytes(std::size_t, std::span<std::byte>) const { refuse(file_); }
void Hdf5Dataset::append_bytes(std::span<const std::byte>) { refuse(file_); }
void Hdf5Dataset::resize(std::size_t) { refuse(file_); }
void Hdf5Dataset::flush() { refuse(file_); }
void Hdf5Dataset::append(const void*, std::size_t, engine::Element) { refuse(file_); }
void Hdf5Dataset::write_rows(std::size_t, std::size_t, const void*, std::size_t, engine::Element) {
  refuse(file_);
}
void Hdf5Dataset::read_rows(std::size_t, void*, std::size_t, engine::Element) const { refuse(file_); }

Hdf5Group Hdf5Group::create_group(const std::string&) { refuse(file_); }
Hdf5Group Hdf5Group::group(const std::string&) const { refuse(file_); }
bool Hdf5Group::has(const std::string&) const { refuse(file_); }
bool Hdf5Group::has_group(const std::string&) const { refuse(file_); }
std::vector<std::string> Hdf5Group::names() const { refuse(file_); }
std::vector<std::string> Hdf5Group::paths() const { refuse(file_); }
std::vector<std::uint64_t> Hdf5Group::header_addresses() const { refuse(file_); }
void Hdf5Group::copy_content(const Hdf5Group&) { refuse(file_); }
Hdf5Dataset Hdf5Group::create_dataset(const std::string&, engine::Element, const std::vector<std::size_t>&) {
  refuse(file_);
}
Hdf5Dataset Hdf5Group::create_extendible(const std::string&, engine::Element, const std::vector<std::size_t>&,
                                         const Hdf5Chunks&) {
  refuse(file_);
}
Hdf5Dataset Hdf5Group::dataset(const std::string&) const { refuse(file_); }
void Hdf5Group::write_text(const std::string&, std::string_view) { refuse(file_); }
std::string Hdf5Group::read_text(const std::string&) const { refuse(file_); }
void Hdf5Group::write_texts(const std::string&, std::span<const std::string>) { refuse(file_); }
std::vector<std::string> Hdf5Group::read_texts(const std::string&) const { refuse(file_); }

Hdf5File Hdf5File::create(const std::filesystem::path& file, std::size_t) { refuse(file); }
Hdf5File Hdf5File::create_in_memory(const std::filesystem::path& file, std::size_t) { refuse(file); }
Hdf5File Hdf5File::open(const std::filesystem::path& file) { refuse(file); }
Hdf5File Hdf5File::open_swmr(const std::filesystem::path& file) { refuse(file); }
Hdf5File Hdf5File::open_to_write(const std::filesystem::path& file) { refuse(file); }
void Hdf5File::start_swmr() { refuse(file_); }
void Hdf5File::flush() { refuse(file_); }
std::uint64_t Hdf5File::unused_bytes() const { refuse(file_); }
std::vector<std::byte> Hdf5File::image() { refuse(file_); }
void Hdf5File::shrink_cache() { refuse(file_); }
void Hdf5File::close() { refuse(file_); }
void Hdf5File::abandon() noexcept {}

}  // namespace troupe::worldio
