#include "nodes/scene_build/cache_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>
#include <system_error>

namespace voxtouch::scene_build {
namespace {

constexpr std::size_t kDigest = 32;

/// Numbers as this machine has them: another one has another digest of its builders.
struct Head {
  std::array<char, 8> mark{'v', 'x', 't', 's', 'c', 'e', 'n', 'e'};
  std::uint64_t layout = 1;
  std::uint64_t recipe = 0, content = 0;  ///< [bytes]

  std::string_view bytes() const noexcept {
    return {reinterpret_cast<const char*>(this), sizeof *this};
  }
};
static_assert(sizeof(Head) == 32);

class OpenFile {
 public:
  explicit OpenFile(int number) noexcept : number_(number) {}
  ~OpenFile() {
    if (number_ >= 0)
      ::close(number_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int number() const noexcept { return number_; }

 private:
  int number_;
};

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR)
      continue;
    if (written < 0)
      fail("write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// Fewer bytes than asked for where the file ends.
std::size_t read_up_to(int file, char* to, std::size_t size) {
  std::size_t have = 0;
  while (have < size) {
    const ssize_t got = ::read(file, to + have, size - have);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      fail("read");
    if (got == 0)
      break;
    have += static_cast<std::size_t>(got);
  }
  return have;
}

void require(bool holds, const char* why) {
  if (!holds)
    throw std::runtime_error(why);
}

}  // namespace

std::string sha256(std::initializer_list<std::string_view> parts) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        EVP_MD_CTX_free);
  std::string digest(kDigest, '\0');
  bool well = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (const std::string_view part : parts)
    well = well && EVP_DigestUpdate(context.get(), part.data(), part.size()) == 1;
  if (!well || EVP_DigestFinal_ex(context.get(), reinterpret_cast<unsigned char*>(digest.data()),
                                  nullptr) != 1)
    throw std::runtime_error("the library has no SHA-256");
  return digest;
}

std::string hex(std::string_view bytes) {
  return fmt::format(
      "{:02x}",
      fmt::join(std::span(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()), ""));
}

std::uint64_t overhead_bytes(std::string_view recipe) noexcept {
  return sizeof(Head) + kDigest + recipe.size();
}

void write_cache_file(const std::filesystem::path& file, std::string_view recipe,
                      std::string_view content) {
  Head head;
  head.recipe = recipe.size(), head.content = content.size();
  const std::string digest = sha256({head.bytes(), recipe, content});
  std::string name = file.string() + ".XXXXXX";
  const OpenFile out(::mkostemp(name.data(), O_CLOEXEC));  // mode 0600
  if (out.number() < 0)
    fail("mkostemp");
  try {
    write_all(out.number(), head.bytes()), write_all(out.number(), digest),
        write_all(out.number(), recipe), write_all(out.number(), content);
    if (::rename(name.c_str(), file.c_str()) != 0)
      fail("rename");
  } catch (...) {
    ::unlink(name.c_str());
    throw;
  }
}

rendering::Kept read_cache_file(const std::filesystem::path& file, std::string_view recipe,
                                std::uint64_t most_bytes) {
  const OpenFile in(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (in.number() < 0 && errno == ENOENT)
    return {};
  if (in.number() < 0)
    fail("open");
  struct stat is {};
  if (::fstat(in.number(), &is) != 0)
    fail("fstat");
  require(S_ISREG(is.st_mode), "it is no regular file");
  require(is.st_uid == ::geteuid() && (is.st_mode & 022) == 0, "others may have written it");
  const auto size = static_cast<std::uint64_t>(is.st_size);
  const std::uint64_t before = overhead_bytes(recipe);
  require(size >= sizeof(Head) && size <= most_bytes + before, "it is too short or too large");
  auto memory = std::make_unique_for_overwrite<char[]>(size);
  require(read_up_to(in.number(), memory.get(), size) == size, "it is cut off");
  const std::string_view all(memory.get(), size);
  Head head, own;
  std::memcpy(&head, all.data(), sizeof head);
  require(head.mark == own.mark && head.layout == own.layout, "it has another layout");
  require(head.recipe == recipe.size() && size >= before && head.content == size - before,
          "it is cut off, or kept for another scene");
  const std::string_view digest = all.substr(sizeof head, kDigest),
                         body = all.substr(sizeof head + kDigest);
  require(digest == sha256({head.bytes(), body}), "its checksum is wrong");
  require(body.starts_with(recipe), "it is kept for another scene");
  ::futimens(in.number(), nullptr);  // used now; where that fails it is forgotten sooner
  rendering::Kept kept;
  kept.content = body.substr(recipe.size());
  kept.memory = std::move(memory);
  return kept;
}

}  // namespace voxtouch::scene_build
