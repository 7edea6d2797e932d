// A bag as it lies on disk: its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_file.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

constexpr char kMagic[] = "#ROSBAG V2.0\n";
constexpr char kRemedy[] = ": it is cut short, damaged or no bag; copy it again or leave it out";

enum class Kind : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what + kRemedy); }

/// A file, or what a record of it holds, from some position on.
class Bytes {
 public:
  Bytes(std::istream* in, std::uint64_t position, std::uint64_t end)
      : in_(in), at_(position), end_(end) {
    in_->clear();
    in_->seekg(static_cast<std::streamoff>(position));
  }

  std::uint64_t at() const { return at_; }
  bool done() const { return at_ == end_; }
  std::string take(std::uint32_t size) {
    require(size);
    std::string bytes(size, '\0');
    if (!in_->read(&bytes[0], size)) refuse("cannot be read at byte " + std::to_string(at_));
    at_ += size;
    return bytes;
  }
  void skip(std::uint32_t size) {
    require(size);
    at_ += size;
    in_->seekg(static_cast<std::streamoff>(at_));
  }

 private:
  void require(std::uint32_t size) const {
    if (size > end_ - at_) {
      refuse(std::to_string(size) + " bytes are due at byte " + std::to_string(at_) + ", " +
             std::to_string(end_ - at_) + " are there");
    }
  }

  std::istream* in_;
  std::uint64_t at_;
  std::uint64_t end_;
};

template <class Number>
Number numberOf(const std::string& bytes) {
  if (bytes.size() != sizeof(Number))
    refuse("a number has " + std::to_string(bytes.size()) + " bytes");
  Number value;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

std::uint32_t takeSize(Bytes* bytes) { return numberOf<std::uint32_t>(bytes->take(4)); }

/// NAME=VALUE, each with its size before it.
class Fields {
 public:
  explicit Fields(const std::string& text) {
    std::istringstream in(text);
    Bytes bytes(&in, 0, text.size());
    while (!bytes.done()) {
      const std::string field = bytes.take(takeSize(&bytes));
      const std::size_t sign = field.find('=');
      if (sign == std::string::npos) refuse("a field has no name");
      fields_[field.substr(0, sign)] = field.substr(sign + 1);
    }
  }

  const std::string& text(const std::string& name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end()) refuse("a record has no field " + name);
    return found->second;
  }
  template <class Number>
  Number number(const std::string& name) const {
    return numberOf<Number>(text(name));
  }
  Kind kind() const { return static_cast<Kind>(number<std::uint8_t>("op")); }
  [[noreturn]] void refuseKind(const std::string& place) const {
    refuse("a record " + place + " has the unknown op " +
           std::to_string(number<std::uint8_t>("op")));
  }

 private:
  std::map<std::string, std::string> fields_;
};

/// The topic is in the record's own fields, the rest in its data.
BagConnection connectionOf(const Fields& record, const std::string& data) {
  const Fields fields(data);
  return {record.text("topic"), fields.text("type"), fields.text("md5sum")};
}

constexpr std::uint32_t kMaxChunk = 256U << 20U;
constexpr std::uint64_t kLz4Ratio = 255;  // a byte of LZ4 stands for 255 bytes at most
constexpr std::size_t kBz2Piece = 65536;

std::string fromLz4(std::string data, std::uint32_t size) {
  if (size > kLz4Ratio * data.size()) {
    refuse("a chunk of " + std::to_string(data.size()) + " bytes of LZ4 announces " +
           std::to_string(size));
  }
  std::string out(size, '\0');
  unsigned written = size;
  const int result =
      roslz4_buffToBuffDecompress(&data[0], static_cast<unsigned>(data.size()), &out[0], &written);
  if (result != ROSLZ4_OK || written != size) refuse("a chunk of LZ4 is damaged");
  return out;
}

/// A few bytes of BZ2 may stand for many, so memory is taken as it is filled.
/// @throws std::bad_alloc without enough of it
std::string fromBz2(std::string data, std::uint32_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
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
  if (!whole || out.size() != size) refuse("a chunk of BZ2 is damaged");
  return out;
}

/// @param compression  none, lz4 or bz2
/// @param size         that the result must have                                 [bytes]
/// @throws std::runtime_error if the compression is another, the size is beyond 256 MB or more
///         than this many bytes can hold, or the data are damaged
std::string decompressChunk(const std::string& compression, const std::string& data,
                            std::uint32_t size) {
  if (size > kMaxChunk) {
    refuse("a chunk announces " + std::to_string(size) + " bytes, at most " +
           std::to_string(kMaxChunk) + " are allowed");
  }
  if (compression == "lz4") return fromLz4(data, size);
  if (compression == "bz2") return fromBz2(data, size);
  if (compression != "none") {
    refuse("a chunk has the compression '" + compression + "', known are none, lz4 and bz2");
  }
  if (data.size() != size) {
    refuse("a chunk has " + std::to_string(data.size()) + " bytes, it announces " +
           std::to_string(size));
  }
  return data;
}

}  // namespace

BagFile::BagFile(std::istream* in) : in_(in) {
  in_->clear();
  in_->seekg(0, std::ios::end);
  const auto end = static_cast<std::streamoff>(in_->tellg());
  if (end < 0) refuse("cannot be read");
  size_ = static_cast<std::uint64_t>(end);
  Bytes front(in_, 0, size_);
  if (front.take(sizeof(kMagic) - 1) != kMagic) refuse("does not begin as a bag of format 2.0");
  const Fields header(front.take(takeSize(&front)));
  if (header.kind() != Kind::kBagHeader) refuse("has no header");
  front.skip(takeSize(&front));  // blanks, so that the header can be written again
  first_ = front.at();
  index_ = header.number<std::uint64_t>("index_pos");
  num_chunks_ = header.number<std::uint32_t>("chunk_count");
  if (index_ == 0) throw std::runtime_error("was not closed; run `rosbag reindex` on it");
  if (index_ < first_ || index_ > size_) {
    refuse("its header puts the index at byte " + std::to_string(index_) +
           ", it must lie between byte " + std::to_string(first_) + " and the end of the file at " +
           std::to_string(size_));
  }

  std::uint32_t num_chunks = 0;
  Bytes bytes(in_, index_, size_);
  while (!bytes.done()) {
    const Fields fields(bytes.take(takeSize(&bytes)));
    const std::uint32_t size = takeSize(&bytes);
    if (fields.kind() == Kind::kConnection) {
      connections_[fields.number<std::uint32_t>("conn")] = connectionOf(fields, bytes.take(size));
    } else if (fields.kind() == Kind::kChunkInfo) {
      bytes.skip(size);
      ++num_chunks;
    } else {
      fields.refuseKind("in its index");
    }
  }
  const auto num_connections = header.number<std::uint32_t>("conn_count");
  if (connections_.size() != num_connections || num_chunks != num_chunks_) {
    refuse("its header announces " + std::to_string(num_connections) + " connections and " +
           std::to_string(num_chunks_) + " chunks, its index lists " +
           std::to_string(connections_.size()) + " and " + std::to_string(num_chunks));
  }
}

void BagFile::forEachMessage(const TakeMessage& take) {
  const auto takeChunk = [&](const std::string& chunk) {
    std::istringstream in(chunk);
    Bytes bytes(&in, 0, chunk.size());
    while (!bytes.done()) {
      const Fields fields(bytes.take(takeSize(&bytes)));
      const std::string data = bytes.take(takeSize(&bytes));
      if (fields.kind() == Kind::kConnection) continue;  // they are in the index, too
      if (fields.kind() != Kind::kMessage) fields.refuseKind("in a chunk");
      const auto number = fields.number<std::uint32_t>("conn");
      const auto connection = connections_.find(number);
      if (connection == connections_.end()) {
        refuse("a message is of connection " + std::to_string(number) +
               ", which its index does not list");
      }
      take(connection->second, data);
    }
  };
  std::uint32_t num_chunks = 0;
  Bytes bytes(in_, first_, index_);
  while (!bytes.done()) {
    const Fields fields(bytes.take(takeSize(&bytes)));
    const std::uint32_t size = takeSize(&bytes);
    if (fields.kind() == Kind::kChunk) {
      const std::string data = bytes.take(size);
      const std::string& compression = fields.text("compression");
      const auto chunk_size = fields.number<std::uint32_t>("size");
      std::string chunk;
      try {
        chunk = decompressChunk(compression, data, chunk_size);
      } catch (const std::bad_alloc&) {
        throw std::runtime_error("not enough memory for a chunk (" + compression + ") of " +
                                 std::to_string(chunk_size) +
                                 " bytes: end other programs, then read it again");
      }
      takeChunk(chunk);
      ++num_chunks;
    } else if (fields.kind() == Kind::kIndex) {
      bytes.skip(size);
    } else {
      fields.refuseKind("among its chunks");
    }
  }
  if (num_chunks != num_chunks_) {
    refuse("its header announces " + std::to_string(num_chunks_) + " chunks, it holds " +
           std::to_string(num_chunks));
  }
}

}  // namespace ddm
