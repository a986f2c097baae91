; What code that numba compiled asks of its runtime: arrays, which are counted, and exceptions, which end the program.
; For one thread on a memory that begins with zeros, whose first 48 KiB are nobody else's.
;
; Blocks are powers of two. Those that are free are lists, one for each power k, that begin at the address 4 k; the
; end of all blocks, the first of which begins at 1024, stands at the address 256. A block has 64 bytes before its
; numbers: the count, k at byte 8, the next free block at byte 16, and the address of the numbers at byte 24, where
; compiled code looks for it.

declare double @llvm.sqrt.f64(double)
declare void @llvm.trap() cold noreturn nounwind
declare i64 @llvm.ctlz.i64(i64, i1)
declare i64 @llvm.umax.i64(i64, i64)

define void @raise() noreturn {
  call void @llvm.trap()
  unreachable
}

define nonnull ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
  %whole = add i64 %size, 63
  %zeros = call i64 @llvm.ctlz.i64(i64 %whole, i1 true)
  %k = sub i64 64, %zeros
  %list = shl i64 %k, 2
  %head = inttoptr i64 %list to ptr
  %free = load ptr, ptr %head
  %none = icmp eq ptr %free, null
  br i1 %none, label %fresh, label %used
used:
  %link = getelementptr i8, ptr %free, i64 16
  %next = load ptr, ptr %link
  store ptr %next, ptr %head
  br label %ready
fresh:
  %before = load i64, ptr inttoptr (i64 256 to ptr)
  %begin = call i64 @llvm.umax.i64(i64 %before, i64 1024)
  %bytes = shl i64 1, %k
  %end = add i64 %begin, %bytes
  %over = icmp ugt i64 %end, 49152
  br i1 %over, label %full, label %room
full:
  call void @llvm.trap()
  unreachable
room:
  store i64 %end, ptr inttoptr (i64 256 to ptr)
  %new = inttoptr i64 %begin to ptr
  br label %ready
ready:
  %block = phi ptr [ %free, %used ], [ %new, %room ]
  %power = getelementptr i8, ptr %block, i64 8
  %data = getelementptr i8, ptr %block, i64 24
  %numbers = getelementptr i8, ptr %block, i64 64
  store i64 1, ptr %block
  store i64 %k, ptr %power
  store ptr %numbers, ptr %data
  ret ptr %block
}

define void @NRT_incref(ptr %block) {
  %none = icmp eq ptr %block, null
  br i1 %none, label %done, label %some
some:
  %count = load i64, ptr %block
  %more = add i64 %count, 1
  store i64 %more, ptr %block
  br label %done
done:
  ret void
}

define void @NRT_decref(ptr %block) {
  %none = icmp eq ptr %block, null
  br i1 %none, label %done, label %some
some:
  %count = load i64, ptr %block
  %less = sub i64 %count, 1
  store i64 %less, ptr %block
  %last = icmp eq i64 %less, 0
  br i1 %last, label %free, label %done
free:
  %power = getelementptr i8, ptr %block, i64 8
  %k = load i64, ptr %power
  %list = shl i64 %k, 2
  %head = inttoptr i64 %list to ptr
  %next = load ptr, ptr %head
  %link = getelementptr i8, ptr %block, i64 16
  store ptr %next, ptr %link
  store ptr %block, ptr %head
  br label %done
done:
  ret void
}

define double @sqrt(double %x) {
  %root = call double @llvm.sqrt.f64(double %x)
  ret double %root
}
