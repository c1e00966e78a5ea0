#include "io/recording/decompress.hpp"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

namespace modebank {

namespace {

/// One step in decompressing a stream: the numbers of bytes taken and made, and whether the stream has ended.
struct Step {
  std::size_t taken = 0, made = 0;
  bool ended = false;
  std::string failure;
};

class Bz2Stream {
 public:
  Bz2Stream() {
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  ~Bz2Stream() { BZ2_bzDecompressEnd(&stream_); }
  Bz2Stream(const Bz2Stream&) = delete;
  Bz2Stream& operator=(const Bz2Stream&) = delete;

  Step step(std::string_view packed, char* to, std::size_t room) {
    constexpr std::size_t most = std::numeric_limits<unsigned>::max();
    stream_.next_in = const_cast<char*>(packed.data());  // NOLINT: the library's interface is older than const
    stream_.avail_in = static_cast<unsigned>(std::min(packed.size(), most));
    stream_.next_out = to;
    stream_.avail_out = static_cast<unsigned>(std::min(room, most));
    const unsigned given = stream_.avail_in, offered = stream_.avail_out;
    const int status = BZ2_bzDecompress(&stream_);
    Step step{given - stream_.avail_in, offered - stream_.avail_out, status == BZ_STREAM_END, {}};
    if (status == BZ_MEM_ERROR) throw std::bad_alloc();
    if (status != BZ_OK && status != BZ_STREAM_END) step.failure = fmt::format("bzip2 error {}", status);
    return step;
  }

 private:
  bz_stream stream_{};
};

class Lz4Stream {
 public:
  Lz4Stream() {
    LZ4F_dctx* made = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) throw std::bad_alloc();
    context_.reset(made);
  }

  Step step(std::string_view packed, char* to, std::size_t room) {
    std::size_t taken = packed.size(), made = room;
    const std::size_t status = LZ4F_decompress(context_.get(), to, &made, packed.data(), &taken, nullptr);
    if (LZ4F_isError(status)) return {0, 0, false, LZ4F_getErrorName(status)};
    return {taken, made, status == 0, {}};
  }

 private:
  std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context_{nullptr, LZ4F_freeDecompressionContext};
};

class ZstdStream {
 public:
  ZstdStream() {
    if (context_ == nullptr) throw std::bad_alloc();
  }

  Step step(std::string_view packed, char* to, std::size_t room) {
    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    ZSTD_outBuffer out{to, room, 0};
    const std::size_t status = ZSTD_decompressStream(context_.get(), &out, &in);
    if (ZSTD_isError(status)) return {in.pos, out.pos, false, ZSTD_getErrorName(status)};
    return {in.pos, out.pos, status == 0, {}};
  }

 private:
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_{ZSTD_createDCtx(), ZSTD_freeDCtx};
};

template <class Stream>
Unpacked unpack_stream(std::string_view packed, std::size_t declared, Buffer& buffer) {
  // Compressed images do not reach `usual_ratio`. A higher compression ratio needs more rounds.
  constexpr std::size_t usual_ratio = 8, least = 1 << 16;
  Stream stream;
  std::size_t made = 0;
  std::size_t room = std::min(declared + 1, std::max({least, usual_ratio * packed.size(), buffer.capacity()}));
  buffer.reserve(room, 0);
  for (;;) {
    const Step step = stream.step(packed, buffer.data() + made, room - made);
    packed.remove_prefix(step.taken);
    made += step.made;
    const std::string_view bytes{buffer.data(), std::min(made, declared)};
    if (made > declared)
      return {bytes, fmt::format("it decompresses to more than the {} bytes that it declares", declared)};
    if (!step.failure.empty()) return {bytes, step.failure};
    if (step.ended && packed.empty())
      return {bytes,
              made == declared ? "" : fmt::format("it decompresses to {} bytes, but declares {}", made, declared)};
    if (step.ended) return {bytes, "there are bytes after the compressed data"};
    if (made < room && step.taken == 0 && step.made == 0) return {bytes, "the compressed data are cut off"};
    if (made == room) {
      room = std::min(declared + 1, 2 * room);
      buffer.reserve(room, made);
    }
  }
}

}  // namespace

char* Buffer::reserve(std::size_t bytes, std::size_t kept) {
  if (bytes <= capacity_) return data();
  auto larger = std::make_unique_for_overwrite<char[]>(bytes);
  if (kept > 0) std::memcpy(larger.get(), bytes_.get(), kept);
  bytes_ = std::move(larger);
  capacity_ = bytes;
  return data();
}

Unpacked unpack(Compression compression, std::string_view packed, std::uint64_t declared, Buffer& buffer) {
  const auto size = static_cast<std::size_t>(declared);
  switch (compression) {
    case Compression::bz2:
      return unpack_stream<Bz2Stream>(packed, size, buffer);
    case Compression::lz4:
      return unpack_stream<Lz4Stream>(packed, size, buffer);
    case Compression::zstd:
      return unpack_stream<ZstdStream>(packed, size, buffer);
    case Compression::none:
      break;
  }
  return {packed, packed.size() == size ? "" : "its size is not the declared one"};
}

std::uint64_t zstd_content_bytes(std::string_view packed) {
  return ZSTD_getFrameContentSize(packed.data(), packed.size());  // zstd uses the two largest numbers as error codes
}

}  // namespace modebank
