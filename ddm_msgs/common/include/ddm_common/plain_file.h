// Reads and writes whole files, and expands paths in a home folder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// Refuses pipes and devices: reading from a pipe can block without end, and reading from a device
/// can exhaust the memory.
/// @throws std::runtime_error unless the path is a regular file
void requirePlainFile(const std::string& path);

/// Reads a regular file.
/// @throws std::runtime_error with the path and the reason
std::string readFile(const std::string& path);

/// Tries to write a file, before the work whose result it is to hold. The file does not change.
/// @throws std::runtime_error if writeFileAtomically() would refuse this path
void requireWritable(const std::string& path);

/// Writes bytes to a new file next to `path` and renames it to `path`, so `path` never contains an
/// incomplete file. If several processes or threads write at once, one of their files remains,
/// complete. After a power failure, `path` contains the old or the new content; it contains the new
/// content if this function had returned.
/// @throws std::runtime_error with the path and the reason, also if `path` exists and is not a
///         regular file; `path` is then unchanged, unless the disk failed during the last step
void writeFileAtomically(const std::string& path, const std::string& bytes);

/// Removes the incomplete files that killed processes left behind in writeFileAtomically(), in a
/// folder and its subfolders. Use it only for a folder in which no other process writes.
void removeUnfinished(const std::string& folder);

/// Renames a closed file durably. The content of the file is on the disk before the file is
/// renamed, and the new name is on the disk before this function returns. After a power failure, no
/// incomplete file has the new name.
/// @throws std::runtime_error with the path and the reason
void renameDurably(const std::string& from, const std::string& to);

/// Replaces `~` in `~/x` and `~name` in `~name/x` by the home folder. A shell does so only at the
/// start of a word, not in `--out=~/x`, and not in `runs:=~/x` of roslaunch. Any other text is
/// returned unchanged.
/// @param word  path, or option with a path as its value, such as `--out=~/x`
std::string expandHome(std::string word);

}  // namespace ddm
