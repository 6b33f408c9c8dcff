#include "io_pattern.h"

#include <cstdio>

#include "host/host_errors.h"
#include "host/pattern_export.h"
#include "host/rich_parameters.h"

QString PatternIOPlugin::pluginName() const {
    return "IOPattern";
}

QList<MeshIOInterface::Format> PatternIOPlugin::importFormats() const {
    return {};
}

QList<MeshIOInterface::Format> PatternIOPlugin::exportFormats() const {
    return {Format("SVG pattern", "SVG"), Format("PDF pattern", "PDF")};
}

// Nothing to choose: a pattern has no colours, normals or qualities.
void PatternIOPlugin::GetExportMaskCapability(QString&, int& capability, int& default_bits) const {
    capability = 0;
    default_bits = 0;
}

void PatternIOPlugin::initSaveParameter(const QString&, MeshModel&, RichParameterList& parameters) {
    parameters = devseg::host::pattern_parameters();
}

bool PatternIOPlugin::open(const QString&, const QString&, MeshModel&, int&,
                           const RichParameterList&, vcg::CallBackPos*, QWidget*) {
    return fail("expected a mesh to open, found a pattern: patterns can only be saved");
}

bool PatternIOPlugin::save(const QString&, const QString& file_name, MeshModel& model, int,
                           const RichParameterList& parameters, vcg::CallBackPos* callback,
                           QWidget*) {
    clearErrorString();
    try {
        for (const std::string& note :
             devseg::host::save_pattern(file_name.toStdString(), model, parameters, callback))
            Log(GLLogStream::WARNING, note);
        return true;
    } catch (const devseg::host::HostError& error) {
        return fail(devseg::host::to_qstring(error.what()));
    }
}

// The window shows errorMessage. The batch server neither shows it nor gives a log to file
// formats, so that the text goes to its standard error.
bool PatternIOPlugin::fail(const QString& message) {
    errorMessage = message;
    std::fprintf(stderr, "devseg: error: %s\n", qUtf8Printable(message));
    return false;
}
