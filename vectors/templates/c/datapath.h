/* The @NAME@ datapath. Errors: NULL, KNOB, EFFECTS, INPUT. Effects that it does not have change nothing. */
int32_t roughxel_@NAME@(const roughxel_profile *profile, uint32_t effects,
                        const roughxel_@NAME@_in *inputs, roughxel_@NAME@_out *outputs);
/* The lowest and the highest number of each of its inputs. Errors: NULL, KNOB. */
int32_t roughxel_@NAME@_input_range(const roughxel_profile *profile,
                                    roughxel_@NAME@_in *low, roughxel_@NAME@_in *high);
