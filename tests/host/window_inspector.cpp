// Lets a test see the windows of a running MeshLab: preloaded into its process, it listens on the
// local socket DEVSEG_INSPECTOR and answers every line "widgets" with the widgets as one line of
// JSON, and "menus" with the entries of all menus. Nothing is clicked or changed from here: the
// test does that with the X server's mouse and keyboard, as a user does.
#include <QAbstractItemView>
#include <QApplication>
#include <QDockWidget>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLocalServer>
#include <QLocalSocket>
#include <QMenu>
#include <QTimer>

namespace {

QJsonArray rows(const QAbstractItemView& view) {
    QJsonArray texts;
    const QAbstractItemModel* model = view.model();
    for (int row = 0; model != nullptr && row < model->rowCount(view.rootIndex()); ++row)
        texts.append(model->index(row, 0, view.rootIndex()).data().toString());
    return texts;
}

QJsonObject describe(QWidget& widget) {
    const QPoint corner = widget.mapToGlobal(QPoint(0, 0));
    QJsonObject record{
        {"class", widget.metaObject()->className()},
        {"name", widget.objectName()},
        {"window", widget.window()->windowTitle()},
        {"visible", widget.isVisible()},
        {"enabled", widget.isEnabled()},
        {"tip", widget.toolTip()},
        {"box", QJsonArray{corner.x(), corner.y(), widget.width(), widget.height()}}};
    // Labels, buttons, line edits, spin boxes and docks say what they show under these names.
    for (const char* name : {"text", "title", "currentText", "plainText", "checked", "value"}) {
        const QVariant value = widget.property(name);
        if (value.isValid())
            record[name] = QJsonValue::fromVariant(value);
    }
    for (QWidget* parent = &widget; parent != nullptr; parent = parent->parentWidget())
        if (qobject_cast<QDockWidget*>(parent) != nullptr) {
            record["dock"] = parent->windowTitle();
            break;
        }
    if (const auto* view = qobject_cast<QAbstractItemView*>(&widget))
        record["rows"] = rows(*view);
    return record;
}

QJsonArray widgets() {
    QJsonArray all;
    for (QWidget* widget : QApplication::allWidgets())
        all.append(describe(*widget));
    return all;
}

QJsonArray menus() {
    QJsonArray all;
    for (QWidget* widget : QApplication::allWidgets())
        if (auto* menu = qobject_cast<QMenu*>(widget)) {
            QJsonArray entries;
            for (const QAction* action : menu->actions())
                entries.append(QJsonObject{{"text", action->text()}, {"tip", action->toolTip()}});
            all.append(QJsonObject{
                {"title", menu->title()}, {"visible", menu->isVisible()}, {"entries", entries}});
        }
    return all;
}

void serve() {
    const QString name = qEnvironmentVariable("DEVSEG_INSPECTOR");
    if (name.isEmpty() || qobject_cast<QApplication*>(qApp) == nullptr)
        return;
    auto* server = new QLocalServer(qApp);
    QObject::connect(server, &QLocalServer::newConnection, [server] {
        QLocalSocket* socket = server->nextPendingConnection();
        QObject::connect(socket, &QLocalSocket::readyRead, [socket] {
            while (socket->canReadLine()) {
                const bool asks_menus = socket->readLine().trimmed() == "menus";
                const QJsonArray answer = asks_menus ? menus() : widgets();
                socket->write(QJsonDocument(answer).toJson(QJsonDocument::Compact) + "\n");
            }
        });
        QObject::connect(socket, &QLocalSocket::disconnected, socket, &QObject::deleteLater);
    });
    if (!server->listen(name))
        qFatal("inspector: cannot listen on %s", qUtf8Printable(name));
}

// The application object is not complete yet when this runs.
void start() {
    QTimer::singleShot(0, qApp, serve);
}

} // namespace

Q_COREAPP_STARTUP_FUNCTION(start)
