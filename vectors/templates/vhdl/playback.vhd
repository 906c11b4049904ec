-- @NAME@_playback: no device. It hands out the expected words of the set, so that the bench itself can be tried.
--
-- With ALTERED of 0 or more the field @FIRST_OUTPUT@ of that vector has its lowest bit inverted, which the bench has to find.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use std.textio.all;
use work.@NAME@_pkg.all;

entity @NAME@_playback is
  generic (
    WORDS   : string;
    ALTERED : integer
  );
  port (
    clk       : in  std_ulogic;
    rst       : in  std_ulogic;
    in_valid  : in  std_ulogic;
    in_ready  : out std_ulogic;
    inputs    : in  inputs_t;
    out_valid : out std_ulogic;
    out_ready : in  std_ulogic;
    outputs   : out outputs_t
  );
end entity;

architecture simulation of @NAME@_playback is
  signal is_full : std_ulogic := '0';
begin

  in_ready  <= out_ready or not is_full;
  out_valid <= is_full;

  process (clk) is
    file played        : text open read_mode is WORDS;
    variable word      : word_t;
    variable is_good   : boolean;
    variable index     : natural := 0;
    variable played_as : outputs_t;
  begin
    if rising_edge(clk) then
      if rst = '1' then
        is_full <= '0';
      elsif (out_ready or not is_full) = '1' then
        is_full <= in_valid;
        if in_valid = '1' then
          read_word(played, word, is_good);
          assert is_good and inputs_of(word) = inputs
            report "ERROR the inputs are not those of vector " & to_string(index) severity failure;
          played_as := outputs_of(word);
          if index = ALTERED then
            played_as.@FIRST_OUTPUT@(0) := not played_as.@FIRST_OUTPUT@(0);
          end if;
          outputs <= played_as;
          index := index + 1;
        end if;
      end if;
    end if;
  end process;

end architecture;
