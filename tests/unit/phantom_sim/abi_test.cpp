// The library's interface for a linker and for the registers of a call.
#include <elf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>

#include "library.hpp"

extern "C" int hdsim_header_is_c(void);  // in c_header.c

namespace voxtouch::hd_sim_test {
namespace {

/// Names of the defined symbols in .dynsym, read from the file itself.
std::set<std::string> dynamic_symbols(const char* path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> file{std::istreambuf_iterator<char>(in), {}};
  std::set<std::string> names;
  if (file.size() < sizeof(Elf64_Ehdr))
    return names;
  Elf64_Ehdr header;
  std::memcpy(&header, file.data(), sizeof header);
  std::vector<Elf64_Shdr> sections(header.e_shnum);
  std::memcpy(sections.data(), file.data() + header.e_shoff, sections.size() * sizeof(Elf64_Shdr));
  for (const Elf64_Shdr& section : sections) {
    if (section.sh_type != SHT_DYNSYM)
      continue;
    const char* strings = file.data() + sections[section.sh_link].sh_offset;
    for (std::size_t at = 0; at < section.sh_size; at += sizeof(Elf64_Sym)) {
      Elf64_Sym symbol;
      std::memcpy(&symbol, file.data() + section.sh_offset + at, sizeof symbol);
      if (symbol.st_shndx != SHN_UNDEF)
        names.insert(strings + symbol.st_name);
    }
  }
  return names;
}

class Abi : public SimulatedLibrary {};

TEST_F(Abi, ExportsTheDriversFunctionsAndHooksOnly) {
  std::set<std::string> expected;
#define VOXTOUCH_HD_NAME(name, result, arguments) expected.insert(#name);
  VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_NAME)
#undef VOXTOUCH_HD_NAME
  std::set<std::string> found, hooks;
  for (const std::string& name : dynamic_symbols(VOXTOUCH_HD_SIM_LIBRARY))
    (name.starts_with("hdsim_") ? hooks : found).insert(name);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(hooks.size(), sizeof(Hooks) / sizeof(void*));
}

TEST_F(Abi, HeaderOfTheHooksIsC) { EXPECT_EQ(hdsim_header_is_c(), sizeof(hdsim_state)); }

TEST_F(Abi, ErrorComesByValueInTwoRegisters) {
  open();
  api.hdEndFrame(device);
  const phantom::hd::HDErrorInfo info = api.hdGetError();
  EXPECT_EQ(info.error_code, phantom::hd::kIllegalEnd);
  EXPECT_EQ(info.internal_error_code, 0);
  EXPECT_EQ(info.device, device);
  // The same call with twelve bytes as the calling convention passes them: eight in one register,
  // four in the next.
  struct Registers {
    unsigned long low, high;
  };
  const auto raw = reinterpret_cast<Registers (*)()>(dlsym(handle(), "hdGetError"));
  api.hdInitDevice(nullptr);  // again: no handle belongs to this error
  const Registers r = raw();
  EXPECT_EQ(r.low & 0xFFFFFFFF, phantom::hd::kDeviceAlreadyInitiated);
  EXPECT_EQ(r.high & 0xFFFFFFFF, phantom::hd::kInvalidHandle);
}

TEST_F(Abi, EveryErrorHasASentence) {
  std::set<std::string> all;
  for (const phantom::hd::HDerror code :
       {phantom::hd::kSuccess, phantom::hd::kInvalidEnum, phantom::hd::kWarmMotors,
        phantom::hd::kDeviceFault, phantom::hd::kCommError, phantom::hd::kTimerError,
        phantom::hd::kIllegalBegin, phantom::hd::kFrameError, phantom::hd::kInvalidLicense,
        0x7777u})
    all.insert(api.hdGetErrorString(code));
  EXPECT_EQ(all.size(), 10u);
}

}  // namespace
}  // namespace voxtouch::hd_sim_test
