// The exceptions of the core. Messages are for users: what was expected, what was found, and what
// to do (name the MeshLab filter that repairs it).
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace devseg {

class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The mesh cannot be processed. `faces` are the offending input faces, for selection in the host.
class InvalidMesh : public Error {
public:
    explicit InvalidMesh(const std::string& message, std::vector<std::int32_t> offending = {})
        : Error(message), faces(std::move(offending)) {}

    std::vector<std::int32_t> faces;
};

/// A parameter is out of its range.
class InvalidParameter : public Error {
public:
    using Error::Error;
};

/// A solver failed on valid input; the message names the chart and what to try.
class NumericalFailure : public Error {
public:
    using Error::Error;
};

/// A file cannot be written.
class FileError : public Error {
public:
    using Error::Error;
};

/// The user cancelled. Nothing has changed.
class Cancelled : public Error {
public:
    Cancelled() : Error("cancelled: nothing was changed") {}
};

} // namespace devseg
