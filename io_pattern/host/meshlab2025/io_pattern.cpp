#include "io_pattern.h"

#include "host/host_errors.h"
#include "host/pattern_export.h"
#include "host/rich_parameters.h"

QString PatternIOPlugin::pluginName() const {
    return "IOPattern";
}

QString PatternIOPlugin::vendor() const {
    return "devseg";
}

std::list<FileFormat> PatternIOPlugin::importFormats() const {
    return {};
}

std::list<FileFormat> PatternIOPlugin::exportFormats() const {
    return {FileFormat("SVG pattern", QString("SVG")), FileFormat("PDF pattern", QString("PDF"))};
}

// Nothing to choose: a pattern has no colours, normals or qualities.
void PatternIOPlugin::exportMaskCapability(const QString&, int& capability,
                                           int& default_bits) const {
    capability = 0;
    default_bits = 0;
}

RichParameterList PatternIOPlugin::initSaveParameter(const QString&, const MeshModel&) const {
    return devseg::host::pattern_parameters();
}

void PatternIOPlugin::open(const QString&, const QString&, MeshModel&, int&,
                           const RichParameterList&, vcg::CallBackPos*) {
    throw MLException("expected a mesh to open, found a pattern: patterns can only be saved");
}

void PatternIOPlugin::save(const QString& format, const QString& file_name, MeshModel& model, int,
                           const RichParameterList& parameters, vcg::CallBackPos* callback) {
    if (format.compare("svg", Qt::CaseInsensitive) != 0 &&
        format.compare("pdf", Qt::CaseInsensitive) != 0)
        wrongSaveFormat(format);
    try {
        for (const std::string& note :
             devseg::host::save_pattern(file_name.toStdString(), model, parameters, callback))
            reportWarning(devseg::host::to_qstring(note));
    } catch (const devseg::host::HostError& error) {
        throw MLException(devseg::host::to_qstring(error.what()));
    }
}
