// A bag as it lies on disk: its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_file.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <cstring>
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

/// @param compression  none, lz4 or bz2
/// @param size         that the result must have                                 [bytes]
/// @throws std::runtime_error if the compression is another, the size is beyond 256 MB or more
///         than this many bytes can hold, or the data are damaged
std::string decompressChunk(const std::string& compression, const std::string& data,
                            std::uint32_t size) {
  if (size > kMaxChunk) {
    throw std::runtime_error("a chunk has more than " + std::to_string(kMaxChunk) + " bytes");
  }
  if (compression == "lz4") return fromLz4(data, size);
  if (compression == "bz2") return fromBz2(data, size);
  if (compression != "none") {
    throw std::runtime_error("a chunk has an unknown compression '" + compression + "'");
  }
  if (data.size() != size) throw std::runtime_error("a chunk has another size than it announces");
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
  if (index_ < first_ || index_ > size_) refuse("its index is not in the file");

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
      refuse("an unknown record is in its index");
    }
  }
  if (connections_.size() != header.number<std::uint32_t>("conn_count") ||
      num_chunks != num_chunks_) {
    refuse("its index is not complete");
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
      if (fields.kind() != Kind::kMessage) refuse("an unknown record is in a chunk");
      const auto connection = connections_.find(fields.number<std::uint32_t>("conn"));
      if (connection == connections_.end()) refuse("a message is of an unknown topic");
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
      std::string chunk;
      try {
        chunk =
            decompressChunk(fields.text("compression"), data, fields.number<std::uint32_t>("size"));
      } catch (const std::exception& e) {
        refuse(e.what());
      }
      takeChunk(chunk);
      ++num_chunks;
    } else if (fields.kind() == Kind::kIndex) {
      bytes.skip(size);
    } else {
      refuse("an unknown record is among its chunks");
    }
  }
  if (num_chunks != num_chunks_) refuse("its chunks are not complete");
}

}  // namespace ddm
