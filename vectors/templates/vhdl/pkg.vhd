-- @NAME@_pkg: the fields of the vector set @SET@ for a bench.
--
-- set.json has unit and description of every field.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use std.textio.all;

package @NAME@_pkg is

  constant N_VECTORS   : positive := @COUNT@;
  constant WORD_BITS   : positive := @WORD_BITS@;
  constant OUTPUT_BITS : positive := @OUTPUT_BITS@;
  -- Of the file of words.
  constant SHA256 : string := "@SHA256@";

  -- A word as its file has it: every field on whole hex digits, the check value last.
  subtype word_t is std_ulogic_vector(WORD_BITS - 1 downto 0);

  -- What goes in, in the word's order.
  type inputs_t is record
@VHDL_INPUT_MEMBERS@
  end record;

  -- What comes out, earliest stage first.
  type outputs_t is record
@VHDL_OUTPUT_MEMBERS@
  end record;

  -- The inputs of a word.
  function inputs_of(word : word_t) return inputs_t;

  -- The outputs that belong to them.
  function outputs_of(word : word_t) return outputs_t;

  -- The word with other outputs; its check value stays.
  function with_outputs(word : word_t; outputs : outputs_t) return word_t;

  -- Whether a word was read whole: its last 32 bits are the CRC-32 of those above.
  function is_whole(word : word_t) return boolean;

  -- Hex digits in lower case, zeros above the field.
  function digits(bits : std_ulogic_vector) return string;

  -- The next word of a file. `is_good` is false at its end and where a line is no word of this set.
  procedure read_word(file words : text; word : out word_t; is_good : out boolean);

  -- How many fields differ, taps aside with `outputs_only`; prints each, earliest stage first, if not `silent`.
  procedure compare(
    index : natural; expected, got : outputs_t; outputs_only, silent : boolean; differing : out natural);

end package;

package body @NAME@_pkg is

  function inputs_of(word : word_t) return inputs_t is
    variable result : inputs_t;
  begin
@VHDL_INPUT_PARTS@
    return result;
  end function;

  function outputs_of(word : word_t) return outputs_t is
    variable result : outputs_t;
  begin
@VHDL_OUTPUT_PARTS@
    return result;
  end function;

  function with_outputs(word : word_t; outputs : outputs_t) return word_t is
    variable result : word_t := word;
  begin
@VHDL_OUTPUT_PLACES@
    return result;
  end function;

  function is_whole(word : word_t) return boolean is
    constant POLYNOMIAL : std_ulogic_vector(31 downto 0) := x"04c11db7";
    variable crc : std_ulogic_vector(31 downto 0) := x"ffffffff";
  begin
    for i in WORD_BITS - 1 downto 32 loop
      if (crc(31) xor word(i)) = '1' then
        crc := (crc(30 downto 0) & '0') xor POLYNOMIAL;
      else
        crc := crc(30 downto 0) & '0';
      end if;
    end loop;
    return crc = word(31 downto 0);
  end function;

  procedure read_word(file words : text; word : out word_t; is_good : out boolean) is
    variable row    : line;
    variable place  : integer;
    variable digit  : natural;
    variable symbol : character;
  begin
    is_good := false;
    loop
      if endfile(words) then
        return;
      end if;
      readline(words, row);
      exit when row'length < 2;
      exit when row(row'left) /= '/' or row(row'left + 1) /= '/';
    end loop;
    place := WORD_BITS;
    for i in row'range loop
      symbol := row(i);
      if symbol /= '_' then
        case symbol is
          when '0' to '9' => digit := character'pos(symbol) - character'pos('0');
          when 'a' to 'f' => digit := character'pos(symbol) - character'pos('a') + 10;
          when others => return;
        end case;
        place := place - 4;
        if place < 0 then
          return;
        end if;
        word(place + 3 downto place) := std_ulogic_vector(to_unsigned(digit, 4));
      end if;
    end loop;
    is_good := place = 0;
  end procedure;

  -- The number of a field: its integer over 2^fraction_bits. Of a field beside an exponent that is the mantissa alone.
  function number(bits : std_ulogic_vector; is_signed : boolean; fraction_bits : natural) return real is
    variable sum : real := 0.0;
  begin
    for i in bits'range loop
      sum := 2.0 * sum;
      if to_x01(bits(i)) = '1' then
        if is_signed and i = bits'left then
          sum := sum - 1.0;
        else
          sum := sum + 1.0;
        end if;
      end if;
    end loop;
    return sum / 2.0 ** fraction_bits;
  end function;

  function digits(bits : std_ulogic_vector) return string is
    variable result : string(1 to (bits'length + 3) / 4) := to_hstring(bits);
  begin
    for i in result'range loop
      if result(i) >= 'A' and result(i) <= 'F' then
        result(i) := character'val(character'pos(result(i)) + 32);
      end if;
    end loop;
    return result;
  end function;

  procedure compare(
    index : natural; expected, got : outputs_t; outputs_only, silent : boolean; differing : out natural) is

    variable found : natural := 0;

    procedure field(stage, name : string; is_tap, is_signed : boolean; fraction_bits : natural;
                    expected, got : std_ulogic_vector) is
      variable row : line;
    begin
      if expected /= got and not (outputs_only and is_tap) then
        found := found + 1;
        if silent then
          return;
        end if;
        write(row, "@SET@ #" & to_string(index) & ": stage " & stage & ", field " & name
              & ": expected " & digits(expected)
              & " = " & to_string(number(expected, is_signed, fraction_bits), "%.10g")
              & ", got " & digits(got)
              & " = " & to_string(number(got, is_signed, fraction_bits), "%.10g"));
        writeline(output, row);
      end if;
    end procedure;

  begin
@VHDL_COMPARISONS@
    differing := found;
  end procedure;

end package body;
