#include "nodes/bus/opaque_serdata.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_keyhash.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <new>

namespace voxtouch::bus {
namespace {

constexpr std::size_t kHeaderBytes = 4;  // encapsulation: representation identifier, options

std::size_t padded(std::size_t size) noexcept { return (size + 3) & ~std::size_t{3}; }

// One allocation: the struct, then the bytes, then zeros up to a multiple of 4, which the protocol may read
// and send.
OpaqueSerdata* allocate(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) noexcept {
  void* memory = ::operator new(sizeof(OpaqueSerdata) + padded(size), std::nothrow);
  if (memory == nullptr) return nullptr;
  auto* serdata = new (memory) OpaqueSerdata();
  ddsi_serdata_init(serdata, type, kind);
  serdata->hash = type->serdata_basehash;  // keyless: all samples of all opaque topics are one instance
  serdata->data = static_cast<std::byte*>(memory) + sizeof(OpaqueSerdata);
  serdata->byte_count = static_cast<std::uint32_t>(size);
  std::memset(serdata->data + size, 0, padded(size) - size);
  serdata->reception_time_ns = dds_time();
  return serdata;
}

const OpaqueSerdata* self(const ddsi_serdata* serdata) noexcept { return static_cast<const OpaqueSerdata*>(serdata); }

bool eqkey(const ddsi_serdata*, const ddsi_serdata*) { return true; }

std::uint32_t get_size(const ddsi_serdata* serdata) { return self(serdata)->byte_count; }

// Fragments may overlap: `have` bytes stand already, of each fragment only what lies beyond is taken.
ddsi_serdata* from_ser(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment, std::size_t size) {
  if (kind != SDK_DATA) return allocate(type, kind, 0);
  if (size < kHeaderBytes) return nullptr;
  OpaqueSerdata* serdata = allocate(type, kind, size);
  if (serdata == nullptr) return nullptr;
  std::size_t have = 0;
  for (; fragment != nullptr && have < size; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= have) continue;
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
    std::memcpy(serdata->data + have, payload + (have - fragment->min), end - have);
    have = end;
  }
  if (have == size) return serdata;
  ddsi_serdata_unref(serdata);  // a message with a hole in it is no message
  return nullptr;
}

ddsi_serdata* from_ser_iov(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                           const ddsrt_iovec_t* parts, std::size_t size) {
  if (kind != SDK_DATA) return allocate(type, kind, 0);
  if (size < kHeaderBytes) return nullptr;
  OpaqueSerdata* serdata = allocate(type, kind, size);
  if (serdata == nullptr) return nullptr;
  std::size_t have = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && have < size; ++i) {
    const std::size_t n = std::min<std::size_t>(parts[i].iov_len, size - have);
    std::memcpy(serdata->data + have, parts[i].iov_base, n);
    have += n;
  }
  if (have == size) return serdata;
  ddsi_serdata_unref(serdata);
  return nullptr;
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) { return allocate(type, SDK_KEY, 0); }

ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
  if (kind != SDK_DATA) return allocate(type, kind, 0);
  const auto& bytes = *static_cast<const OpaqueBytes*>(sample);
  if (bytes.size() < kHeaderBytes) return nullptr;
  OpaqueSerdata* serdata = allocate(type, kind, bytes.size());
  if (serdata != nullptr) std::memcpy(serdata->data, bytes.data(), bytes.size());
  return serdata;
}

void to_ser(const ddsi_serdata* serdata, std::size_t offset, std::size_t size, void* out) {
  std::memcpy(out, self(serdata)->data + offset, size);
}

ddsi_serdata* to_ser_ref(const ddsi_serdata* serdata, std::size_t offset, std::size_t size, ddsrt_iovec_t* out) {
  out->iov_base = self(serdata)->data + offset;
  out->iov_len = size;
  return ddsi_serdata_ref(serdata);
}

void to_ser_unref(ddsi_serdata* serdata, const ddsrt_iovec_t*) { ddsi_serdata_unref(serdata); }

// The C read calls would want a sample; the opaque reader only uses takecdr, and invalid samples carry
// nothing.
bool to_sample(const ddsi_serdata*, void*, void**, void*) { return false; }
bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return true; }

ddsi_serdata* to_untyped(const ddsi_serdata* serdata) {
  OpaqueSerdata* key = allocate(serdata->type, SDK_KEY, 0);
  if (key != nullptr) key->type = nullptr;
  return key;
}

void free_serdata(ddsi_serdata* serdata) {
  auto* opaque = static_cast<OpaqueSerdata*>(serdata);
  opaque->~OpaqueSerdata();
  ::operator delete(opaque);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata* serdata, char* out, std::size_t size) {
  return static_cast<std::size_t>(std::snprintf(out, size, "opaque(%u bytes)", self(serdata)->byte_count));
}

void get_keyhash(const ddsi_serdata*, ddsi_keyhash* out, bool) { std::memset(out->value, 0, sizeof(out->value)); }

constexpr ddsi_serdata_ops make_serdata_ops() {
  ddsi_serdata_ops ops{};
  ops.eqkey = eqkey;
  ops.get_size = get_size;
  ops.from_ser = from_ser;
  ops.from_ser_iov = from_ser_iov;
  ops.from_keyhash = from_keyhash;
  ops.from_sample = from_sample;
  ops.to_ser = to_ser;
  ops.to_ser_ref = to_ser_ref;
  ops.to_ser_unref = to_ser_unref;
  ops.to_sample = to_sample;
  ops.to_untyped = to_untyped;
  ops.untyped_to_sample = untyped_to_sample;
  ops.free = free_serdata;
  ops.print = print;
  ops.get_keyhash = get_keyhash;
  return ops;  // no iceoryx calls: the type is not of fixed size, so shared memory is never chosen for it
}

const ddsi_serdata_ops kSerdataOps = make_serdata_ops();

void free_sertype(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}
// same ops and same name: the same type
bool equal(const ddsi_sertype*, const ddsi_sertype*) { return true; }
std::uint32_t hash(const ddsi_sertype*) { return 0; }

// No type id, map or information: matching falls back to the type's name, against writers with and without
// them.
ddsi_sertype_ops make_sertype_ops() {
  ddsi_sertype_ops ops{};
  ops.version = ddsi_sertype_v0;
  ops.free = free_sertype;
  ops.zero_samples = zero_samples;
  ops.realloc_samples = realloc_samples;
  ops.free_samples = free_samples;
  ops.equal = equal;
  ops.hash = hash;
  return ops;
}

const ddsi_sertype_ops kSertypeOps = make_sertype_ops();

}  // namespace

ddsi_sertype* make_opaque_sertype(const char* type_name) {
  auto* type = new ddsi_sertype();
  ddsi_sertype_init(type, type_name, &kSertypeOps, &kSerdataOps, /*topickind_no_key=*/true);
  return type;
}

const OpaqueSerdata& as_opaque(const ddsi_serdata* serdata) noexcept { return *self(serdata); }

}  // namespace voxtouch::bus
