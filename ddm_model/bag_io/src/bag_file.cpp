// A bag as it lies on disk: its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_file.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <cstring>
#include <new>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

constexpr char kMagic[] = "#ROSBAG V2.0\n";
constexpr char kRemedy[] = ": it is cut short, damaged or no bag; copy it again or leave it out";

/// What people take for a bag, by its first bytes.
struct OtherFormat {
  std::string magic;
  const char* what;
  const char* remedy;
};
const OtherFormat kOtherFormats[] = {
    {"\x89MCAP0\r\n", "a recording of ROS 2 or Foxglove (MCAP)",
     "convert it with `rosbags-convert --src FILE.mcap --dst FILE.bag` (pip install rosbags)"},
    {std::string("SQLite format 3\0", 16), "a recording of ROS 2 (SQLite, .db3)",
     "convert its folder with `rosbags-convert --src FOLDER --dst FILE.bag` (pip install rosbags)"},
    {"version https://git-lfs", "a pointer of Git LFS instead of the file",
     "download the file with `git lfs pull`"},
    {"#ROSBAG V1", "a bag of format 1, which ROS wrote until 2010",
     "convert it with `rosbag filter OLD.bag NEW.bag True`"},
    {"#ROSRECORD V1", "a bag of format 1, which ROS wrote until 2010",
     "convert it with `rosbag filter OLD.bag NEW.bag True`"},
    {"\x1f\x8b", "compressed as a whole (gzip)", "unpack it with `gunzip` or `tar xzf`"},
    {"PK\x03\x04", "a zip archive", "unpack it with `unzip`"},
    {"BZh", "compressed as a whole (bzip2)", "unpack it with `bunzip2` or `tar xjf`"},
    {std::string("\xfd"
                 "7zXZ\0",
                 6),
     "compressed as a whole (xz)", "unpack it with `unxz` or `tar xJf`"},
    {"\x28\xb5\x2f\xfd", "compressed as a whole (Zstandard)", "unpack it with `unzstd`"},
    {"7z\xbc\xaf\x27\x1c", "a 7-Zip archive", "unpack it with `7z x`"},
    {"Rar!\x1a\x07", "a RAR archive", "unpack it with `unrar x`"}};
constexpr const char* kWebPages[] = {"<!doctype", "<html", "<?xml"};  // behind blanks, in any case
constexpr char kTar[] = "ustar";
constexpr std::size_t kTarAt = 257;
constexpr std::uint32_t kLongestMagic = kTarAt + sizeof(kTar) - 1;

enum class Kind : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

/// To tell it from what is wrong with a message.
struct Damage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void refuse(const std::string& what) { throw Damage(what + kRemedy); }

[[noreturn]] void refuseFormat(const std::string& what, const std::string& remedy) {
  throw std::runtime_error("is " + what + "; only bags of format 2.0 (ROS 1) are read: " + remedy);
}

void requireBag(const std::string& front) {
  for (const OtherFormat& format : kOtherFormats) {
    if (front.compare(0, format.magic.size(), format.magic) != 0) continue;
    refuseFormat(format.what, format.remedy);
  }
  for (const char* begin : kWebPages) {
    if (boost::algorithm::istarts_with(boost::algorithm::trim_left_copy(front), begin)) {
      refuseFormat("a web page instead of the file", "download the file itself");
    }
  }
  if (front.size() > kTarAt && front.compare(kTarAt, sizeof(kTar) - 1, kTar) == 0) {
    refuseFormat("a tar archive", "unpack it with `tar xf`");
  }
  if (front.compare(0, sizeof(kMagic) - 1, kMagic) != 0) {
    refuse("does not begin as a bag of format 2.0");
  }
}

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
    goTo(at_ + size);
  }
  void goTo(std::uint64_t position) {
    at_ = position;
    in_->seekg(static_cast<std::streamoff>(position));
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

  bool has(const std::string& name) const { return fields_.count(name) > 0; }
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
  return {record.text("topic"), fields.text("type"), fields.text("md5sum"),
          fields.has("callerid") ? fields.text("callerid") : ""};
}

ros::Time timeOf(const Fields& fields) {
  const auto time = fields.number<std::uint64_t>("time");  // seconds, then nanoseconds
  return {static_cast<std::uint32_t>(time), static_cast<std::uint32_t>(time >> 32U)};
}

constexpr std::uint32_t kMaxChunk = 256U << 20U;
constexpr std::uint64_t kLz4Ratio = 255;  // a byte of LZ4 stands for 255 bytes at most
constexpr std::size_t kBz2Chunk = 65536;

std::string fromLz4(std::string data, std::uint32_t size) {
  if (size > kLz4Ratio * data.size()) {
    refuse(std::to_string(data.size()) + " bytes of LZ4 announce " + std::to_string(size));
  }
  std::string out(size, '\0');
  unsigned written = size;
  const int result =
      roslz4_buffToBuffDecompress(&data[0], static_cast<unsigned>(data.size()), &out[0], &written);
  if (result != ROSLZ4_OK || written != size) refuse("its LZ4 is damaged");
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
    out.resize(std::min<std::size_t>(size, filled + std::max(filled, kBz2Chunk)));
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
  if (!whole || out.size() != size) refuse("its BZ2 is damaged");
  return out;
}

/// @param size  that the result must have                                        [bytes]
/// @throws std::runtime_error if the compression is none that is known, the size is more than this
///         many bytes can hold, or the data are damaged
std::string decompressChunk(const std::string& compression, const std::string& data,
                            std::uint32_t size) {
  try {
    if (compression == "lz4") return fromLz4(data, size);
    if (compression == "bz2") return fromBz2(data, size);
  } catch (const std::bad_alloc&) {
    throw Damage("not enough memory for its " + std::to_string(size) + " bytes (" + compression +
                 "): end other programs, then read it again");
  }
  throw Damage("it has the compression '" + compression +
               "', known are none, lz4 and bz2: write the bag again with one of them, or copy it "
               "again if it is damaged");
}

}  // namespace

BagFile::BagFile(std::istream* in) : in_(in) {
  in_->clear();
  in_->seekg(0, std::ios::end);
  const auto end = static_cast<std::streamoff>(in_->tellg());
  if (end < 0) refuse("cannot be read");
  size_ = static_cast<std::uint64_t>(end);
  Bytes front(in_, 0, size_);
  requireBag(front.take(static_cast<std::uint32_t>(std::min<std::uint64_t>(kLongestMagic, size_))));
  front.goTo(sizeof(kMagic) - 1);
  const Fields header(front.take(takeSize(&front)));
  if (header.kind() != Kind::kBagHeader) refuse("has no header");
  if (header.has("encryptor") && !header.text("encryptor").empty()) {
    throw std::runtime_error("is encrypted by " + header.text("encryptor") +
                             ": decrypt it with `rosbag decrypt`");
  }
  front.skip(takeSize(&front));  // blanks, so that the header can be written again
  first_ = front.at();
  index_ = header.number<std::uint64_t>("index_pos");
  if (index_ == 0) {
    throw std::runtime_error("was not closed: run `rosbag reindex` on it, then read it again");
  }
  if (index_ < first_ || index_ > size_) {
    refuse("its header puts the index at byte " + std::to_string(index_) +
           ", it must lie between byte " + std::to_string(first_) + " and the end of the file at " +
           std::to_string(size_));
  }
  readIndex(header.number<std::uint32_t>("conn_count"),
            header.number<std::uint32_t>("chunk_count"));
}

/// As many records as the header announces; rosbag does not look at what may follow them.
void BagFile::readIndex(std::size_t num_connections, std::size_t num_chunks) {
  Bytes bytes(in_, index_, size_);
  const auto complete = [&] {
    return connections_.size() == num_connections && chunks_.size() == num_chunks;
  };
  while (!bytes.done()) {
    const std::uint64_t position = bytes.at();
    try {
      const Fields fields(bytes.take(takeSize(&bytes)));
      const std::string data = bytes.take(takeSize(&bytes));
      if (fields.kind() == Kind::kConnection) {
        connections_[fields.number<std::uint32_t>("conn")] = connectionOf(fields, data);
      } else if (fields.kind() == Kind::kChunkInfo) {
        Numbers& numbers = chunks_[fields.number<std::uint64_t>("chunk_pos")];
        std::istringstream in(data);
        Bytes counts(&in, 0, data.size());
        while (!counts.done()) {  // number of a connection, number of its messages
          numbers.insert(numberOf<std::uint32_t>(counts.take(4)));
          counts.skip(4);
        }
      } else {
        fields.refuseKind("in its index");
      }
    } catch (const Damage& e) {
      if (complete()) {  // something else follows the index
        after_index_ = size_ - position;
        break;
      }
      throw std::runtime_error("record of the index at byte " + std::to_string(position) + ": " +
                               e.what());
    }
  }
  if (!complete()) {
    refuse("its header announces " + std::to_string(num_connections) + " connections and " +
           std::to_string(num_chunks) + " chunks, its index lists " +
           std::to_string(connections_.size()) + " and " + std::to_string(chunks_.size()));
  }
}

void BagFile::forEachMessageIn(std::istream* chunk, std::uint64_t begin, std::uint64_t end,
                               const Numbers& wanted, const TakeMessage& take) const {
  Bytes bytes(chunk, begin, end);
  while (!bytes.done()) {
    const Fields fields(bytes.take(takeSize(&bytes)));
    const std::uint32_t size = takeSize(&bytes);
    if (fields.kind() == Kind::kConnection) {  // they are in the index, too
      bytes.skip(size);
      continue;
    }
    if (fields.kind() != Kind::kMessage) fields.refuseKind("in a chunk");
    const auto number = fields.number<std::uint32_t>("conn");
    const auto connection = connections_.find(number);
    if (connection == connections_.end()) {
      refuse("a message is of connection " + std::to_string(number) +
             ", which its index does not list");
    }
    if (wanted.count(number) > 0) {
      take({connection->second, timeOf(fields), bytes.take(size)});
    } else {
      bytes.skip(size);
    }
  }
}

void BagFile::forEachMessageInChunk(std::uint64_t position, const Numbers& listed,
                                    const Numbers& wanted, const TakeMessage& take) const {
  if (position < first_ || position >= index_) {
    refuse("it must lie between byte " + std::to_string(first_) + " and the index at " +
           std::to_string(index_));
  }
  Bytes bytes(in_, position, index_);
  const Fields fields(bytes.take(takeSize(&bytes)));
  const std::uint32_t size = takeSize(&bytes);
  const std::uint64_t begin = bytes.at();
  if (fields.kind() != Kind::kChunk) fields.refuseKind("among its chunks");
  bytes.skip(size);
  for (std::size_t i = 0; i < listed.size(); ++i) {  // each connection's messages in this chunk
    const Fields index(bytes.take(takeSize(&bytes)));
    if (index.kind() != Kind::kIndex || listed.count(index.number<std::uint32_t>("conn")) == 0) {
      refuse("the two indices disagree about it");
    }
    bytes.skip(takeSize(&bytes));
  }
  const auto isWanted = [&wanted](std::uint32_t number) { return wanted.count(number) > 0; };
  if (std::none_of(listed.begin(), listed.end(), isWanted)) return;
  const std::string& compression = fields.text("compression");
  const auto chunk_size = fields.number<std::uint32_t>("size");
  if (compression == "none") {
    if (size != chunk_size) {
      refuse("it has " + std::to_string(size) + " bytes and announces " +
             std::to_string(chunk_size));
    }
    return forEachMessageIn(in_, begin, begin + size, wanted, take);
  }
  if (chunk_size > kMaxChunk) {
    refuse("it announces " + std::to_string(chunk_size) + " bytes, at most " +
           std::to_string(kMaxChunk) + " are allowed");
  }
  bytes.goTo(begin);
  const std::string chunk = decompressChunk(compression, bytes.take(size), chunk_size);
  std::istringstream in(chunk);
  forEachMessageIn(&in, 0, chunk.size(), wanted, take);
}

void BagFile::forEachMessage(const std::set<std::string>& topics, const TakeMessage& take) {
  Numbers wanted;
  for (const auto& entry : connections_) {
    if (topics.count(entry.second.topic) > 0) wanted.insert(entry.first);
  }
  for (const auto& chunk : chunks_) {
    try {
      forEachMessageInChunk(chunk.first, chunk.second, wanted, take);
    } catch (const Damage& e) {
      throw std::runtime_error("chunk at byte " + std::to_string(chunk.first) + ": " + e.what());
    }
  }
}

}  // namespace ddm
