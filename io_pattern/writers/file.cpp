#include "writers/file.h"

#include <QSaveFile>
#include <QString>

#include "devseg/base/errors.h"

namespace devseg::writers {

namespace {

[[noreturn]] void refuse(const std::string& path, const QString& reason) {
    throw FileError("expected to write the file '" + path + "', found: " + reason.toStdString() +
                    "; choose a folder that exists, can be written and has room");
}

} // namespace

void save_file(const std::string& path, const std::string& bytes) {
    QSaveFile file(QString::fromStdString(path));
    if (!file.open(QIODevice::WriteOnly))
        refuse(path, file.errorString());
    const auto size = static_cast<qint64>(bytes.size());
    if (file.write(bytes.data(), size) != size || !file.commit())
        refuse(path, file.errorString());
}

} // namespace devseg::writers
