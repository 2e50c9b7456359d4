#include "rig_bridge/modbus/modbus_context.hpp"

namespace rig::modbus {

std::string modbus_error(int number) {
    switch (number) {
        case EMBXILFUN:
            return "exception 1, illegal function";
        case EMBXILADD:
            return "exception 2, illegal data address";
        case EMBXILVAL:
            return "exception 3, illegal data value";
        case EMBXSFAIL:
            return "exception 4, server failure";
        case EMBXACK:
            return "exception 5, acknowledge";
        case EMBXSBUSY:
            return "exception 6, server busy";
        case EMBXNACK:
            return "exception 7, negative acknowledge";
        case EMBXMEMPAR:
            return "exception 8, memory parity error";
        case EMBXGPATH:
            return "exception 10, gateway path unavailable";
        case EMBXGTAR:
            return "exception 11, gateway target failed to respond";
        case EMBBADCRC:
            return "answer with a wrong checksum";
        case EMBBADDATA:
            return "answer that is too long";
        case EMBBADEXC:
        case EMBUNKEXC:
            return "exception with an unknown code";
        case EMBMDATA:
            return "more registers asked for than a request holds";
        case EMBBADSLAVE:
            return "answer of another unit";
        default:
            return modbus_strerror(number);
    }
}

}  // namespace rig::modbus
