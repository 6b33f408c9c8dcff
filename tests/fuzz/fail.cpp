#include <cstdlib>
#include <iostream>

#include "fuzz/bytes.h"

namespace devseg::fuzz {

void fail(const std::string& what) {
    std::cerr << "finding: " << what << std::endl;
    std::abort();
}

} // namespace devseg::fuzz
