        self.take = CSRStorage(fields=[
            CSRField("take", pulse=True, description="Write 1: the constants as they are written count from the next fragment on."),
        ])
        self.pending = CSRStatus(description="1 until a fragment took the constants.")
        taken = Signal()
        self.sync += If(self.take.fields.take, self.pending.status.eq(1)).Elif(taken, self.pending.status.eq(0))
