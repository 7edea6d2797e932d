// A chunk of a bag: messages, often compressed.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_chunk.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <stdexcept>

namespace ddm {
namespace {

constexpr std::uint32_t kMaxSize = 256U << 20U;
constexpr std::uint64_t kLz4Ratio = 255;  // a byte of LZ4 stands for 255 bytes at most
constexpr std::size_t kBz2Piece = 65536;

std::string fromLz4(std::string data, std::uint32_t size) {
  if (size > kLz4Ratio * data.size()) {
    throw std::runtime_error("a chunk of " + std::to_string(data.size()) +
                             " bytes of LZ4 announces " + std::to_string(size));
  }
  std::string out(size, '\0');
  unsigned written = size;
  const int result =
      roslz4_buffToBuffDecompress(&data[0], static_cast<unsigned>(data.size()), &out[0], &written);
  if (result != ROSLZ4_OK || written != size) throw std::runtime_error("a chunk of LZ4 is damaged");
  return out;
}

/// Little can stand for much in BZ2, so memory is taken as it is filled.
std::string fromBz2(std::string data, std::uint32_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
    throw std::runtime_error("there is no memory for a chunk of BZ2");
  }
  stream.next_in = &data[0];
  stream.avail_in = static_cast<unsigned>(data.size());
  std::string out;
  int result = BZ_OK;
  while (result == BZ_OK && out.size() < size) {
    const std::size_t filled = out.size();
    out.resize(std::min<std::size_t>(size, filled + std::max(filled, kBz2Piece)));
    stream.next_out = &out[filled];
    stream.avail_out = static_cast<unsigned>(out.size() - filled);
    result = BZ2_bzDecompress(&stream);
    const std::size_t left = stream.avail_out;
    out.resize(out.size() - left);
    if (result == BZ_OK && left > 0) break;  // the data end early
  }
  // What follows the last byte must be the end with its checksum.
  char beyond = 0;
  if (result == BZ_OK) {
    stream.next_out = &beyond;
    stream.avail_out = 1;
    result = BZ2_bzDecompress(&stream);
  }
  const bool whole = result == BZ_STREAM_END && stream.avail_in == 0;
  BZ2_bzDecompressEnd(&stream);
  if (!whole || out.size() != size) throw std::runtime_error("a chunk of BZ2 is damaged");
  return out;
}

}  // namespace

std::string decompressChunk(const std::string& compression, const std::string& data,
                            std::uint32_t size) {
  if (size > kMaxSize) {
    throw std::runtime_error("a chunk has more than " + std::to_string(kMaxSize) + " bytes");
  }
  if (compression == "lz4") return fromLz4(data, size);
  if (compression == "bz2") return fromBz2(data, size);
  if (compression != "none") {
    throw std::runtime_error("a chunk has an unknown compression '" + compression + "'");
  }
  if (data.size() != size) throw std::runtime_error("a chunk has another size than it announces");
  return data;
}

}  // namespace ddm
