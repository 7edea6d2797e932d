// Files that are read and written as a whole, and paths in a home folder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// A pipe would be waited for without end, and a device read until there is no memory.
/// @throws std::runtime_error unless the path is a file with an end
void requirePlainFile(const std::string& path);

/// @throws std::runtime_error with the path and the reason
std::string readFile(const std::string& path);

/// Writes bytes to a new file next to `path` and renames it: there is never half a file under the
/// name. If several processes or threads write at once, one of their files survives, whole.
/// After a power cut there is the old file or the new one, and the new one if this had returned.
/// @throws std::runtime_error with the path and the reason, also if there is something at the path
///         that is not a regular file; then nothing has changed, unless the disk fails at the end
void writeFileAtomically(const std::string& path, const std::string& bytes);

/// Removes what writeFileAtomically() left behind in a folder, and in those within, when its process
/// was killed. Only for a folder in which no other process writes.
void removeUnfinished(const std::string& folder);

/// Renames a file that somebody else wrote and closed. Its bytes are on the disk before it has the
/// name, and the name is when this returns: after a power cut nothing incomplete has it.
/// @throws std::runtime_error with the path and the reason
void renameDurably(const std::string& from, const std::string& to);

/// `~/x` and `~name/x` with the home folder, which a shell expands at the start of a word only: not in
/// `--out=~/x`, and not in `runs:=~/x` of roslaunch. Any other text stays as it is.
/// @param word  may be an option with its value, `--out=~/x`
std::string expandHome(std::string word);

}  // namespace ddm
