// Files that appear complete or not at all.
#pragma once

#include <string>

namespace devseg::writers {

/// Writes under a temporary name and renames: `path` (UTF-8) holds exactly `bytes` afterwards, or
/// is as it was. Throws FileError.
void save_file(const std::string& path, const std::string& bytes);

} // namespace devseg::writers
