/* @WHAT@ the @DATAPATH@ datapath. */
typedef struct roughxel_@NAME@ {
@MEMBERS@
} roughxel_@NAME@;
/* X(member) for each, in order. */
#define ROUGHXEL_@LARGE@_MEMBERS(X)@PLACES@
