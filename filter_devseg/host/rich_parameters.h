// Between the parameters of the filter table and those of the host.
#pragma once

#include <string>

#include "devseg/declare/filter.h"
#include "host/meshlab_api.h"

namespace devseg::host {

QString to_qstring(const std::string& utf8);

/// What the host asks for: one entry for each declared parameter, in their order.
RichParameterList rich_parameters(const declare::FilterDeclaration& filter);

/// What the host gives back.
declare::ParameterValues parameter_values(const declare::FilterDeclaration& filter,
                                          const RichParameterList& list);

/// Hosts carry reals in 32 bits. The shortest decimal that rounds to the same float is what the
/// user wrote: 0.2 and not 0.200000003.
double as_written(Scalarm value);

} // namespace devseg::host
