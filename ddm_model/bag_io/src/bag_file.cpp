// A bag on disk, with its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_file.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <cerrno>
#include <cstring>

namespace ddm {
namespace {

namespace text = boost::algorithm;

constexpr char kMagic[] = "#ROSBAG V2.0\n";
constexpr std::uint64_t kMaxChunk = 1U << 30U;  // [bytes]; rosbag writes 768 kB
constexpr std::uint64_t kMaxBagHeader = 8192;   // [bytes]; rosbag writes 4096

/// A format that users mistake for a bag, recognised by its first bytes.
struct OtherFormat {
  std::string magic;
  const char* what;
  const char* remedy;
};
const OtherFormat kOtherFormats[] = {
    {"\x89MCAP0\r\n", "a recording of ROS 2 or Foxglove (MCAP)",
     "convert it with `rosbags-convert --src FILE.mcap --dst FILE.bag` (pip install rosbags)"},
    {"SQLite format 3", "a recording of ROS 2 (SQLite, .db3)",
     "convert its folder with `rosbags-convert --src FOLDER --dst FILE.bag` (pip install rosbags)"},
    {"version https://git-lfs", "a pointer of Git LFS instead of the file",
     "download the file with `git lfs pull`"},
    {"#ROSBAG V1", "a bag of format 1 (until 2010)", "run `rosbag filter OLD.bag NEW.bag True`"},
    {"#ROSRECORD V1", "a bag of format 1 (until 2010)", "run `rosbag filter OLD.bag NEW.bag True`"},
    {"\x1f\x8b", "compressed by gzip", "unpack it with `gunzip` or `tar xzf`"},
    {"BZh", "compressed by bzip2", "unpack it with `bunzip2` or `tar xjf`"},
    {"\3757zXZ", "compressed by xz", "unpack it with `unxz` or `tar xJf`"},
    {"\x28\xb5\x2f\xfd", "compressed by Zstandard", "unpack it with `unzstd`"},
    {"PK\x03\x04", "a zip archive", "unpack it with `unzip`"},
    {"7z\xbc\xaf\x27\x1c", "a 7-Zip archive", "unpack it with `7z x`"},
    {"Rar!\x1a\x07", "a RAR archive", "unpack it with `unrar x`"}};
constexpr const char* kWebPages[] = {"<!doctype", "<html", "<?xml"};  // after blanks, in any case
constexpr char kTar[] = "ustar";         // in bytes [257, 262) of a tar archive
constexpr std::size_t kFrontSize = 262;  // [bytes]

/// Kinds of records (field `op`).
enum : std::uint8_t { kMessage = 2, kBagHeader = 3, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

/// A fault of the file, as opposed to a fault of a message.
struct Damage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <class... Parts>
[[noreturn]] void refuseDamage(const Parts&... parts) {
  throw Damage(
      textOf(parts..., ": it is cut short, damaged or no bag; copy it again or leave it out"));
}

/// @param front  first kFrontSize bytes of a file, or fewer if it is shorter
void requireBag(const std::string& front) {
  const auto refuse = [](const std::string& what, const std::string& remedy) {
    refuseBag("is ", what, "; only bags of format 2.0 (ROS 1) are read: ", remedy);
  };
  for (const OtherFormat& format : kOtherFormats) {
    if (text::starts_with(front, format.magic)) refuse(format.what, format.remedy);
  }
  for (const char* begin : kWebPages) {
    if (!text::istarts_with(text::trim_left_copy(front), begin)) continue;
    refuse("a web page instead of the file", "download the file itself");
  }
  if (front.size() == kFrontSize && text::ends_with(front, kTar)) {
    refuse("a tar archive", "unpack it with `tar xf`");
  }
  if (!text::starts_with(front, kMagic)) refuseDamage("does not begin as a bag of format 2.0");
}

/// Removes and returns bytes that are preceded by their size.
std::string takeSized(MessageBytes* stream) {
  std::string bytes;
  try {
    stream->next(bytes);
  } catch (const std::exception& e) {
    refuseDamage("a record ", e.what());
  }
  return bytes;
}

/// Fields NAME=VALUE of a record.
class Fields {
 public:
  explicit Fields(const std::string& bytes) {
    for (MessageBytes stream(bytes.data(), bytes.size()); stream.left() > 0;) {
      const std::string field = takeSized(&stream);
      const std::size_t sign = field.find('=');
      if (sign == std::string::npos) refuseDamage("a field has no name");
      fields_[field.substr(0, sign)] = field.substr(sign + 1);
    }
  }

  /// @return value of a field; empty if it is missing
  std::string text(const std::string& name) const {
    const auto found = fields_.find(name);
    return found == fields_.end() ? "" : found->second;
  }
  template <class Number>
  Number number(const std::string& name) const {
    const std::string bytes = text(name);
    if (bytes.size() != sizeof(Number)) {
      refuseDamage("field ", name, " of a record has ", bytes.size(), " bytes");
    }
    return messageFromBytes<Number>(bytes.data(), bytes.size());
  }

 private:
  std::map<std::string, std::string> fields_;
};

struct Record {
  /// Removes the record from the stream.
  explicit Record(MessageBytes* stream)
      : fields(takeSized(stream)),
        data(takeSized(stream)),
        kind(fields.number<std::uint8_t>("op")) {}

  void requireKind(std::uint8_t wanted) const {
    if (kind == wanted) return;
    refuseDamage("a record has the op ", int{kind}, " where ", int{wanted}, " is due");
  }

  Fields fields;
  std::string data;
  std::uint8_t kind;
};

/// Reads a connection. The header of the record has the topic, its data have the rest.
BagConnection connectionOf(const Record& record) {
  const Fields fields(record.data);
  return {record.fields.text("topic"), fields.text("type"), fields.text("md5sum"),
          fields.text("callerid")};
}

ros::Time timeOf(const Fields& fields) {
  const auto time = fields.number<std::uint64_t>("time");  // seconds, then nanoseconds
  return {static_cast<std::uint32_t>(time), static_cast<std::uint32_t>(time >> 32U)};
}

/// @return the records in a chunk
std::string decompress(Record chunk) {
  const std::string compression = chunk.fields.text("compression");
  const auto size = chunk.fields.number<std::uint32_t>("size");
  std::string& in = chunk.data;
  if (compression == "none") return std::move(in);
  if (size > kMaxChunk) refuseDamage("it announces ", size, " bytes");
  std::string out(size, '\0');
  const auto size_in = static_cast<unsigned>(in.size());
  unsigned written = size;
  bool whole = false;
  if (compression == "lz4") {
    whole = roslz4_buffToBuffDecompress(&in[0], size_in, &out[0], &written) == ROSLZ4_OK;
  } else if (compression == "bz2") {
    whole = BZ2_bzBuffToBuffDecompress(&out[0], &written, &in[0], size_in, 0, 0) == BZ_OK;
  } else {
    throw Damage("it has the compression '" + compression +
                 "', known are none, lz4 and bz2: write the bag again with one of them, or copy it "
                 "again if it is damaged");
  }
  if (!whole || written != size) refuseDamage("its ", compression, " is damaged");
  return out;
}

}  // namespace

BagFile::BagFile(const std::string& path) : in_(path, std::ios::binary) {
  if (!in_) refuseBag(std::strerror(errno));
  in_.seekg(0, std::ios::end);
  const auto size = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in_.tellg()));
  requireBag(read(0, std::min<std::uint64_t>(kFrontSize, size)));
  const std::string front = read(sizeof(kMagic) - 1, std::min<std::uint64_t>(kMaxBagHeader, size));
  MessageBytes front_bytes(front.data(), front.size());
  const Record header(&front_bytes);
  header.requireKind(kBagHeader);
  const std::string encryptor = header.fields.text("encryptor");
  if (!encryptor.empty()) {
    refuseBag("is encrypted by ", encryptor, ": decrypt it with `rosbag decrypt`");
  }
  index_ = header.fields.number<std::uint64_t>("index_pos");
  if (index_ == 0) refuseBag("was not closed: run `rosbag reindex` on it, then read it again");
  if (index_ > size || size - index_ > kMaxChunk) {
    refuseDamage("its index is due at byte ", index_, " of ", size);
  }
  const std::string index = read(index_, size);
  MessageBytes left(index.data(), index.size());
  const auto num_connections = header.fields.number<std::uint32_t>("conn_count");
  const auto num_chunks = header.fields.number<std::uint32_t>("chunk_count");
  while (connections_.size() < num_connections || chunks_.size() < num_chunks) {
    const Record record(&left);
    if (record.kind == kConnection) {
      connections_[record.fields.number<std::uint32_t>("conn")] = connectionOf(record);
    } else {
      record.requireKind(kChunkInfo);
      std::set<std::uint32_t>& held = chunks_[record.fields.number<std::uint64_t>("chunk_pos")];
      // Pairs of the number of a connection and the number of its messages.
      for (std::size_t at = 0; at + 8 <= record.data.size(); at += 8) {
        held.insert(messageFromBytes<std::uint32_t>(&record.data[at], 4));
      }
    }
  }
  bytes_behind_index_ = left.left();
}

/// @return bytes [begin, end) of the file
std::string BagFile::read(std::uint64_t begin, std::uint64_t end) {
  std::string bytes(end - begin, '\0');
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(begin));
  if (!in_.read(&bytes[0], static_cast<std::streamsize>(bytes.size())))
    refuseDamage("cannot be read");
  return bytes;
}

void BagFile::forEachMessage(const std::set<std::string>& topics,
                             const std::function<void(const BagMessage&)>& take) {
  const auto isWanted = [&](std::uint32_t number) {
    const auto found = connections_.find(number);
    return found != connections_.end() && topics.count(found->second.topic) > 0;
  };
  for (auto chunk = chunks_.begin(); chunk != chunks_.end(); ++chunk) {
    if (std::none_of(chunk->second.begin(), chunk->second.end(), isWanted)) continue;
    try {
      const auto next = std::next(chunk);
      const std::uint64_t end = next == chunks_.end() ? index_ : next->first;
      if (end > index_ || chunk->first >= end || end - chunk->first > kMaxChunk) {
        refuseDamage("it does not lie before the index at byte ", index_);
      }
      const std::string bytes = read(chunk->first, end);
      MessageBytes stream(bytes.data(), bytes.size());
      Record record(&stream);
      record.requireKind(kChunk);
      const std::string messages = decompress(std::move(record));
      for (MessageBytes left(messages.data(), messages.size()); left.left() > 0;) {
        const Record message(&left);
        if (message.kind == kConnection) continue;  // the index lists them, too
        message.requireKind(kMessage);
        const auto number = message.fields.number<std::uint32_t>("conn");
        if (connections_.count(number) == 0) {
          refuseDamage("a message is of connection ", number, ", which its index does not list");
        }
        if (isWanted(number)) {
          take({connections_.at(number), timeOf(message.fields), message.data});
        }
      }
    } catch (const Damage& e) {
      refuseBag("chunk at byte ", chunk->first, ": ", e.what());
    }
  }
}

void refuseMessage(const BagMessage& message, const std::exception& fault) {
  refuseBag("the message of topic ", message.connection.topic, " recorded at ",
            timeText(message.recorded), " ", fault.what(), ": leave this bag out");
}

}  // namespace ddm
