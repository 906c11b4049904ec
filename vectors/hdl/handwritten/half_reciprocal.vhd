-- SPEC section 5, "half_reciprocal": 1/(2x) of a mantissa x in [1/2, 1], in [1/2, 1]. Numbers have F fraction bits inside.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use std.textio.all;

entity half_reciprocal is
  generic (
    P     : positive := 20;
    K     : positive := 10;                   -- index bits of the seeds
    STEPS : natural  := 1;
    SEEDS : string   := "reciprocal_10.hex"   -- words of 32 bits, 30 of them fraction bits
  );
  port (
    x : in  signed(P + 1 downto 0);
    h : out signed(P + 1 downto 0)
  );
end entity;

architecture rtl of half_reciprocal is
  -- F of words of 16 or 32 bits.
  function fraction_bits return positive is
  begin
    if P <= 14 then
      return 14;
    end if;
    return 30;
  end function;

  constant F : positive := fraction_bits;

  -- Room for a product of three mantissas.
  subtype wide_t is signed(3 * F + 8 downto 0);
  type seeds_t is array (0 to 2 ** K - 1) of std_ulogic_vector(31 downto 0);

  impure function seeds_of_file return seeds_t is
    file     words  : text open read_mode is SEEDS;
    variable row    : line;
    variable result : seeds_t;
  begin
    for i in result'range loop
      readline(words, row);
      hread(row, result(i));
    end loop;
    return result;
  end function;

  constant SEED : seeds_t := seeds_of_file;
  constant ONE  : wide_t  := shift_left(to_signed(1, wide_t'length), F);

  -- x / 2^places to nearest, ties up.
  function rounded(value : wide_t; places : positive) return wide_t is
  begin
    return shift_right(value + shift_left(to_signed(1, wide_t'length), places - 1), places);
  end function;

  -- A number of 2F fraction bits as a mantissa: p of its F fraction bits are kept.
  function mantissa(value : wide_t) return wide_t is
  begin
    return shift_left(rounded(value, 2 * F - P), F - P);
  end function;
begin

  process (all) is
    variable full, y, limit, residual, operand : wide_t;
    variable index, s                          : integer;
  begin
    full  := shift_left(resize(x, wide_t'length), F - P);
    index := to_integer(shift_right(full - shift_right(ONE, 1), F - K - 1));
    index := maximum(0, minimum(index, 2 ** K - 1));
    -- Of words of 16 bits the upper half: the seeds have K + 2 bits.
    y := resize(shift_right(signed(SEED(index)), 30 - F), wide_t'length);
    s := K - 3;
    for step in 1 to STEPS loop
      limit    := shift_right(shift_left(ONE, F), s);
      residual := shift_left(ONE, F) - shift_left(resize(full * y, wide_t'length), 1);
      residual := maximum(-limit, minimum(residual, limit));
      operand  := mantissa(shift_left(residual, s));
      y        := mantissa(shift_left(y, F) + shift_right(resize(y * operand, wide_t'length), s));
      s        := minimum(2 * s, F - 2);
    end loop;
    y := minimum(y, ONE);
    h <= resize(shift_right(y, F - P), P + 2);
  end process;

end architecture;
