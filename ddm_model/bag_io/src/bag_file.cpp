// A bag on disk, with its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_file.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <cstring>

namespace ddm {
namespace {

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
    {"#ROSBAG V1", "a bag of format 1, which ROS wrote until 2010",
     "convert it with `rosbag filter OLD.bag NEW.bag True`"},
    {"#ROSRECORD V1", "a bag of format 1, which ROS wrote until 2010",
     "convert it with `rosbag filter OLD.bag NEW.bag True`"},
    {"\x1f\x8b", "compressed as a whole (gzip)", "unpack it with `gunzip` or `tar xzf`"},
    {"PK\x03\x04", "a zip archive", "unpack it with `unzip`"},
    {"BZh", "compressed as a whole (bzip2)", "unpack it with `bunzip2` or `tar xjf`"},
    {"\xfd"
     "7zXZ",
     "compressed as a whole (xz)", "unpack it with `unxz` or `tar xJf`"},
    {"\x28\xb5\x2f\xfd", "compressed as a whole (Zstandard)", "unpack it with `unzstd`"},
    {"7z\xbc\xaf\x27\x1c", "a 7-Zip archive", "unpack it with `7z x`"},
    {"Rar!\x1a\x07", "a RAR archive", "unpack it with `unrar x`"}};
constexpr const char* kWebPages[] = {"<!doctype", "<html", "<?xml"};  // after blanks, in any case
constexpr char kTar[] = "ustar";
constexpr std::size_t kTarAt = 257;
constexpr std::uint32_t kLongestMagic = kTarAt + sizeof(kTar) - 1;

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

[[noreturn]] void refuseFormat(const std::string& what, const std::string& remedy) {
  refuseBag("is ", what, "; only bags of format 2.0 (ROS 1) are read: ", remedy);
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
    refuseDamage("does not begin as a bag of format 2.0");
  }
}

/// Removes and returns the first bytes of the rest of a bag.
std::string_view take(std::size_t size, std::string_view* left) {
  if (size > left->size()) {
    refuseDamage(size, " bytes are due where ", left->size(), " are left");
  }
  const std::string_view taken = left->substr(0, size);
  left->remove_prefix(size);
  return taken;
}

template <class Number>
Number numberOf(std::string_view bytes) {
  if (bytes.size() != sizeof(Number)) refuseDamage("a number has ", bytes.size(), " bytes");
  Number value;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

/// Removes and returns bytes that are preceded by their size.
std::string_view takeSized(std::string_view* left) {
  return take(numberOf<std::uint32_t>(take(4, left)), left);
}

/// Fields NAME=VALUE, each preceded by its size.
class Fields {
 public:
  explicit Fields(std::string_view bytes) {
    while (!bytes.empty()) {
      const std::string_view field = takeSized(&bytes);
      const std::size_t sign = field.find('=');
      if (sign == std::string_view::npos) refuseDamage("a field has no name");
      fields_[std::string(field.substr(0, sign))] = field.substr(sign + 1);
    }
  }

  bool has(const std::string& name) const { return fields_.count(name) > 0; }
  std::string text(const std::string& name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end()) refuseDamage("a record has no field ", name);
    return std::string(found->second);
  }
  template <class Number>
  Number number(const std::string& name) const {
    return numberOf<Number>(text(name));
  }

 private:
  std::map<std::string, std::string_view> fields_;
};

struct Record {
  explicit Record(std::string_view* left)
      : fields(takeSized(left)), data(takeSized(left)), kind(fields.number<std::uint8_t>("op")) {}

  void requireKind(std::uint8_t wanted) const {
    if (kind != wanted)
      refuseDamage("a record has the op ", int{kind}, " where ", int{wanted}, " is due");
  }

  Fields fields;
  std::string_view data;
  std::uint8_t kind;
};

/// Reads a connection. The header of the record has the topic, its data have the rest.
BagConnection connectionOf(const Record& record) {
  const Fields fields(record.data);
  return {record.fields.text("topic"), fields.text("type"), fields.text("md5sum"),
          fields.has("callerid") ? fields.text("callerid") : ""};
}

ros::Time timeOf(const Fields& fields) {
  const auto time = fields.number<std::uint64_t>("time");  // seconds, then nanoseconds
  return {static_cast<std::uint32_t>(time), static_cast<std::uint32_t>(time >> 32U)};
}

/// @return the records in a chunk
std::string decompress(const Record& chunk) {
  const std::string compression = chunk.fields.text("compression");
  const auto size = chunk.fields.number<std::uint32_t>("size");
  if (compression == "none") return std::string(chunk.data);
  if (size > kMaxChunk) refuseDamage("it announces ", size, " bytes");
  std::string in(chunk.data), out(size, '\0');
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

BagFile::BagFile(std::istream* in) : in_(in) {
  in_->clear();
  in_->seekg(0, std::ios::end);
  const auto size = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in_->tellg()));
  requireBag(read(0, std::min<std::uint64_t>(kLongestMagic, size)));
  const std::string front = read(0, std::min<std::uint64_t>(kMaxBagHeader, size));
  std::string_view left(front);
  take(sizeof(kMagic) - 1, &left);
  const Record header(&left);
  header.requireKind(kBagHeader);
  if (header.fields.has("encryptor") && !header.fields.text("encryptor").empty()) {
    refuseBag("is encrypted by ", header.fields.text("encryptor"),
              ": decrypt it with `rosbag decrypt`");
  }
  index_ = header.fields.number<std::uint64_t>("index_pos");
  if (index_ == 0) refuseBag("was not closed: run `rosbag reindex` on it, then read it again");
  if (index_ > size || size - index_ > kMaxChunk) {
    refuseDamage("its index is due at byte ", index_, " of ", size);
  }
  const std::string index = read(index_, size);
  left = index;
  const auto num_connections = header.fields.number<std::uint32_t>("conn_count");
  const auto num_chunks = header.fields.number<std::uint32_t>("chunk_count");
  while (connections_.size() < num_connections || chunks_.size() < num_chunks) {
    const Record record(&left);
    if (record.kind == kConnection) {
      connections_[record.fields.number<std::uint32_t>("conn")] = connectionOf(record);
    } else {
      record.requireKind(kChunkInfo);
      std::set<std::uint32_t>& held = chunks_[record.fields.number<std::uint64_t>("chunk_pos")];
      for (std::string_view counts = record.data; !counts.empty(); take(4, &counts)) {
        held.insert(numberOf<std::uint32_t>(take(4, &counts)));
      }
    }
  }
}

/// @return bytes [begin, end) of the file
std::string BagFile::read(std::uint64_t begin, std::uint64_t end) {
  std::string bytes(end - begin, '\0');
  in_->clear();
  in_->seekg(static_cast<std::streamoff>(begin));
  if (!in_->read(&bytes[0], static_cast<std::streamsize>(bytes.size())))
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
      std::string_view left(bytes);
      const Record record(&left);
      record.requireKind(kChunk);
      const std::string messages = decompress(record);
      for (left = messages; !left.empty();) {
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
